// The take as typed arrays.

function bytes(base64) {
  const text = atob(base64);
  const all = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) all[k] = text.charCodeAt(k);
  return all.buffer;
}

function readTake() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const take = { ...data, count: data.frames };
  take.time = new Float64Array(bytes(data.time));
  take.index = new Float64Array(bytes(data.index));
  for (const name of ["pose", "std", "quality", "overlap"]) take[name] = new Float32Array(bytes(data[name]));
  take.used = new Uint8Array(bytes(data.used));
  const leftOut = new Uint8Array(bytes(data.leftOut));
  // Why a view of a frame was left out, if it was; views count on from frame to frame.
  take.whyWithout = (at) => data.leftOutCodes[leftOut[at] - 1];
  // The views that a frame does without, each with the reason.
  take.without = (frame) => take.views.flatMap((name, view) => {
    const why = take.whyWithout(take.views.length * frame + view);
    return why ? [`${name} (${why})`] : [];
  });
  const [frames, codes] = [new Uint32Array(bytes(data.doubtFrames)), new Uint32Array(bytes(data.doubtCodes))];
  take.doubts = new Map();
  frames.forEach((frame, k) => {
    if (!take.doubts.has(frame)) take.doubts.set(frame, []);
    take.doubts.get(frame).push(data.codes[codes[k]]);
  });
  take.doubted = new Uint8Array(take.count);
  frames.forEach((frame) => (take.doubted[frame] = 1));
  take.poseOf = (frame) => take.pose.subarray(28 * frame, 28 * frame + 28);
  take.found = (frame) => !Number.isNaN(take.pose[28 * frame]);
  return take;
}

// The frame nearest to a time.
function frameAt(take, time) {
  let [low, high] = [0, take.count - 1];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (take.time[middle] < time) low = middle + 1;
    else high = middle;
  }
  const before = Math.max(0, low - 1);
  return Math.abs(take.time[before] - time) < Math.abs(take.time[low] - time) ? before : low;
}

const UNITS = { deg: "°", mm: " mm" };

function number(value, unit) {
  return Number.isNaN(value) ? "–" : value.toFixed(1) + UNITS[unit];
}
