// The hand in three dimensions: bones by the pose, a skin on them, drawn by WebGL2.

const VERTEX = `#version 300 es
in vec3 position; in vec3 normal; in float bone;
uniform mat4 bones[17]; uniform mat4 camera; out vec3 facing;
void main() {
  mat4 moved = bones[int(bone)];
  facing = mat3(moved) * normal;
  gl_Position = camera * (moved * vec4(position, 1.0));
}`;
const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 facing; uniform vec3 light; uniform vec3 skin; out vec4 colour;
void main() {
  float shade = 0.62 + 0.38 * dot(normalize(facing), light);
  colour = vec4(skin * shade, 1.0);
}`;

// 4×4 matrices, column by column.
function product(a, b) {
  const c = new Float32Array(16);
  for (let i = 0; i < 4; i++)
    for (let j = 0; j < 4; j++)
      for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
  return c;
}

function placed([x, y, z, w], at) {
  return new Float32Array([
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    at[0], at[1], at[2], 1,
  ]);
}

function aboutAxis([x, y, z], angle) {
  const s = Math.sin(angle / 2);
  return placed([x * s, y * s, z * s, Math.cos(angle / 2)], [0, 0, 0]);
}

// Inverse of a rotation with a shift.
function inverse(m) {
  const r = new Float32Array([m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, 0, 0, 0, 1]);
  for (let i = 0; i < 3; i++) r[12 + i] = -(r[i] * m[12] + r[4 + i] * m[13] + r[8 + i] * m[14]);
  return r;
}

// Each bone's frame for a pose (degrees); the wrist stays where it is.
function boneFrames(skeleton, pose) {
  const frames = [];
  for (const bone of skeleton) {
    let own = placed(bone.rest, bone.offset);
    for (const turn of bone.turns) own = product(own, aboutAxis(turn.axis, (pose[turn.dof] * Math.PI) / 180));
    frames.push(bone.parent === null ? own : product(frames[bone.parent], own));
  }
  return frames;
}

class HandView {
  constructor(canvas, take) {
    this.canvas = canvas;
    this.skeleton = take.skeleton;
    this.fromRest = boneFrames(this.skeleton, new Float32Array(28)).map(inverse);
    [this.yaw, this.pitch, this.distance] = [2.5, 0.75, 480];
    this.gl = canvas.getContext("webgl2", { antialias: true });
    if (this.gl) this.load(take.skin);
    this.listen();
  }

  load(skin) {
    const gl = this.gl;
    const program = (this.program = gl.createProgram());
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    const attribute = (name, values, size) => {
      const at = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
    };
    attribute("position", new Float32Array(bytes(skin.positions)), 3);
    attribute("normal", new Float32Array(bytes(skin.normals)), 3);
    attribute("bone", Float32Array.from(new Uint8Array(bytes(skin.bones))), 1);
    const triangles = new Uint16Array(bytes(skin.triangles));
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    this.corners = triangles.length;
    gl.enable(gl.DEPTH_TEST);
  }

  listen() {
    let last = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!last) return;
      this.turn((last[0] - event.clientX) * 0.01, (event.clientY - last[1]) * 0.01);
      last = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) this.canvas.addEventListener(end, () => (last = null));
    this.canvas.addEventListener("keydown", (event) => {
      const turns = { ArrowLeft: [0.15, 0], ArrowRight: [-0.15, 0], ArrowUp: [0, 0.15], ArrowDown: [0, -0.15] };
      if (turns[event.key]) this.turn(...turns[event.key]);
      else if (event.key === "+" || event.key === "-") this.move(event.key === "+" ? 0.85 : 1 / 0.85);
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  turn(yaw, pitch) {
    this.look(this.yaw + yaw, this.pitch + pitch);
  }

  look(yaw, pitch) {
    this.yaw = yaw;
    this.pitch = Math.max(-1.5, Math.min(1.5, pitch));
    this.draw();
  }

  move(factor) {
    this.distance = Math.max(250, Math.min(1500, this.distance * factor));
    this.draw();
  }

  show(pose) {
    this.pose = pose;
    this.draw();
  }

  // From the hand's frame to the screen, and the direction of the light.
  camera(width, height) {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const back = [sy * cp, sp, cy * cp];
    const right = [cy, 0, -sy];
    const up = [-sy * sp, cp, -cy * sp];
    const middle = [0, 0, 50];
    const along = (axis) => -(axis[0] * middle[0] + axis[1] * middle[1] + axis[2] * middle[2]);
    const view = new Float32Array([
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      along(right), along(up), along(back) - this.distance, 1,
    ]);
    const [near, far, focal] = [50, 3000, 2.6];
    const shape = Math.min(1, width / height);
    const lens = new Float32Array([
      (focal * shape * height) / width, 0, 0, 0, 0, focal * shape, 0, 0,
      0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0,
    ]);
    return [product(lens, view), back.map((b, k) => 0.7 * b + 0.5 * up[k] + 0.3 * right[k])];
  }

  draw() {
    const { gl, canvas } = this;
    if (!gl) return;
    const scale = Math.min(2, devicePixelRatio);
    const [width, height] = [canvas.clientWidth * scale, canvas.clientHeight * scale].map(Math.round);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.pose || Number.isNaN(this.pose[0]) || !width || !height) return;
    const frames = boneFrames(this.skeleton, this.pose);
    const moved = new Float32Array(16 * frames.length);
    frames.forEach((frame, k) => moved.set(product(frame, this.fromRest[k]), 16 * k));
    const [camera, light] = this.camera(width, height);
    const at = (name) => gl.getUniformLocation(this.program, name);
    gl.uniformMatrix4fv(at("bones"), false, moved);
    gl.uniformMatrix4fv(at("camera"), false, camera);
    gl.uniform3fv(at("light"), light);
    const skin = getComputedStyle(document.documentElement).getPropertyValue("--skin").trim();
    gl.uniform3fv(at("skin"), [1, 3, 5].map((k) => parseInt(skin.slice(k, k + 2), 16) / 255));
    gl.drawElements(gl.TRIANGLES, this.corners, gl.UNSIGNED_SHORT, 0);
  }
}
