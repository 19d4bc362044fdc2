// Curves over time: a line with a band, drawn only while on the screen, a column of pixels at a time.

const MARGIN = { left: 56, right: 8, top: 6, bottom: 18 };

class Curve {
  // series: { value(frame), std(frame), low, high, unit } in the file's units; unit is what stands after a number.
  constructor(canvas, take, series, seek) {
    Object.assign(this, { canvas, take, series, visible: false });
    let held = false;
    const go = (event) => {
      const box = canvas.getBoundingClientRect();
      const share = (event.clientX - box.left - MARGIN.left) / (box.width - MARGIN.left - MARGIN.right);
      seek(frameAt(take, this.start + share * (this.end - this.start)));
    };
    canvas.addEventListener("pointerdown", (event) => ((held = true), go(event)));
    canvas.addEventListener("pointermove", (event) => held && go(event));
    for (const end of ["pointerup", "pointercancel", "pointerleave"]) canvas.addEventListener(end, () => (held = false));
  }

  // What of the frames falls on each column of pixels.
  columns(width) {
    const { take, series, start, end } = this;
    const columns = Array.from({ length: width }, () => null);
    const first = Math.max(0, frameAt(take, start) - 1);
    const last = Math.min(take.count - 1, frameAt(take, end) + 1);
    for (let frame = first; frame <= last; frame++) {
      const x = Math.round(((take.time[frame] - start) / (end - start || 1)) * (width - 1));
      if (x < 0 || x >= width) continue;
      const column = (columns[x] ??= { low: Infinity, high: -Infinity, below: Infinity, above: -Infinity, doubted: false, frame });
      if (take.doubted[frame]) column.doubted = true;
      const value = series.value(frame);
      if (!Number.isFinite(value)) continue;
      const std = series.std(frame);
      const band = Number.isFinite(std) ? std : 0;
      column.low = Math.min(column.low, value);
      column.high = Math.max(column.high, value);
      column.below = Math.min(column.below, value - band);
      column.above = Math.max(column.above, value + band);
    }
    return columns;
  }

  draw(start, end, now) {
    Object.assign(this, { start, end, now });
    if (!this.visible) return;
    const { canvas, take, series } = this;
    const scale = Math.min(2, devicePixelRatio);
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    if (!w) return;
    [canvas.width, canvas.height] = [Math.round(w * scale), Math.round(h * scale)];
    const context = canvas.getContext("2d");
    context.scale(scale, scale);
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    const width = Math.max(1, Math.floor(w - MARGIN.left - MARGIN.right));
    const height = h - MARGIN.top - MARGIN.bottom;
    const y = (value) => MARGIN.top + (1 - (value - series.low) / (series.high - series.low || 1)) * height;
    const columns = this.columns(width);
    this.axes(context, colour, width, height, y);
    context.save();
    context.beginPath();
    context.rect(MARGIN.left, MARGIN.top - 2, width, height + 4);
    context.clip();
    this.shade(context, colour, columns, height);
    this.stroke(context, colour, columns, y);
    const x = MARGIN.left + ((take.time[now] - start) / (end - start || 1)) * (width - 1);
    context.fillStyle = colour("--now");
    context.fillRect(x - 0.75, MARGIN.top, 1.5, height);
    context.restore();
  }

  axes(context, colour, width, height, y) {
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = colour("--quiet");
    context.strokeStyle = colour("--edge");
    context.textAlign = "right";
    context.textBaseline = "middle";
    const { low, high, unit } = this.series;
    const decimals = high - low > 3 ? 0 : 2;
    for (const value of [low, (low + high) / 2, high]) {
      context.fillText(value.toFixed(decimals) + unit, MARGIN.left - 5, y(value));
      context.beginPath();
      context.moveTo(MARGIN.left, y(value));
      context.lineTo(MARGIN.left + width, y(value));
      context.stroke();
    }
    context.textBaseline = "alphabetic";
    const digits = this.end - this.start < 3 ? 2 : 1;
    for (const [share, align] of [[0, "left"], [0.5, "center"], [1, "right"]]) {
      context.textAlign = align;
      const time = this.start + share * (this.end - this.start);
      context.fillText(`${time.toFixed(digits)} s`, MARGIN.left + share * width, MARGIN.top + height + 13);
    }
  }

  shade(context, colour, columns, height) {
    context.fillStyle = colour("--doubt");
    const wide = Math.max(1, (columns.length / this.take.count) * ((this.take.time[this.take.count - 1] - this.take.time[0]) / (this.end - this.start || 1)));
    columns.forEach((column, x) => {
      if (column?.doubted) context.fillRect(MARGIN.left + x - wide / 2, MARGIN.top, wide, height);
    });
  }

  stroke(context, colour, columns, y) {
    // A frame without a hand, or a pause, breaks the line.
    const runs = [];
    let run = null;
    columns.forEach((column, x) => {
      if (!column) return;
      if (column.low > column.high) return (run = null);
      if (!run) runs.push((run = []));
      run.push([MARGIN.left + x, column]);
    });
    context.fillStyle = colour("--band");
    context.strokeStyle = colour("--line");
    context.lineWidth = 1.5;
    for (const points of runs) {
      context.beginPath();
      points.forEach(([x, column]) => context.lineTo(x, y(column.above)));
      points.toReversed().forEach(([x, column]) => context.lineTo(x, y(column.below)));
      context.fill();
      context.beginPath();
      if (points.length === 1) context.arc(points[0][0], y(points[0][1].low), 1, 0, 7);
      points.forEach(([x, column]) => {
        context.lineTo(x, y(column.high));
        if (column.low < column.high) context.lineTo(x, y(column.low));
      });
      context.stroke();
    }
  }
}

// The range of an axis that holds a number's values and is not narrower than its motion matters.
function bounds(take, dof, unit) {
  let [low, high] = [Infinity, -Infinity];
  for (let frame = 0; frame < take.count; frame++) {
    const value = take.pose[28 * frame + dof];
    if (!Number.isFinite(value)) continue;
    const std = take.std[28 * frame + dof];
    const band = Number.isFinite(std) ? Math.min(std, 90) : 0;
    low = Math.min(low, value - band);
    high = Math.max(high, value + band);
  }
  if (low > high) return [0, 1];
  const [step, narrowest] = unit === "deg" ? [10, 20] : [10, 20];
  const spare = Math.max(0, narrowest - (high - low)) / 2;
  return [Math.floor((low - spare) / step) * step, Math.ceil((high + spare) / step) * step];
}
