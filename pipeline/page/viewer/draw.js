// Drawing: each side into a picture of its own with depths, then both onto the screen, left and right of the slider, with
// eye-dome lighting (Boucheny 2009): a place is the darker, the farther what is around it stands out towards the eye. It
// shows the shape of a cloud by its depths alone, noise as grain, edges as dark lines.

const kPoints = `#version 300 es
precision highp float;
in vec3 place, move, color;
in vec2 normal;
uniform vec3 origin, right, up, toward, target, slab;
uniform float stride, unit, side, scale, depthRange, reach, slabAt, slabHalf, lit, top;
uniform vec2 screen;
uniform vec3 plain, anchors[5];
uniform int mode;  // 0: plain, 1: own colours, 2: displacement
out vec3 shade;
void main() {
  vec3 away = unit * move;
  vec3 p = origin + stride * place + side * away;
  vec3 d = p - target;
  vec3 seen = vec3(dot(d, right), dot(d, up), dot(d, toward));
  gl_Position = vec4(seen.xy * scale * 2.0 / screen, -seen.z / depthRange, 1.0);
  if (abs(dot(p, slab) - slabAt) > slabHalf) gl_Position = vec4(0, 0, 2, 1);  // clipped
  gl_PointSize = clamp(reach * scale, 2.5, 64.0);
  if (mode == 0) shade = plain;
  if (mode == 1) shade = color;
  if (mode == 2) {
    float at = top > 0.0 ? clamp(4.0 * length(away) / top, 0.0, 4.0) : 0.0;
    int k = min(3, int(at));
    shade = mix(anchors[k], anchors[k + 1], at - float(k));
  }
  if (lit > 0.0) {
    vec2 h = vec2(normal.x + normal.y, normal.x - normal.y) / 254.0;
    vec3 n = normalize(vec3(h, 1.0 - abs(h.x) - abs(h.y)));
    vec3 light = normalize(toward + 0.5 * up - 0.6 * right);
    n *= sign(dot(n, toward) + 1e-9);
    shade *= 0.45 + 0.6 * max(dot(n, light), 0.0);
  }
}`;

const kDisc = `#version 300 es
precision mediump float;
in vec3 shade;
out vec4 pixel;
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  if (dot(at, at) > 1.0) discard;
  pixel = vec4(shade, 1);
}`;

const kCorners = `#version 300 es
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }`;

const kEyeDome = `#version 300 es
precision highp float;
uniform sampler2D colors, depths;
uniform float pixels;  // of the screen along the whole depth
uniform float strength;
uniform ivec2 around[16];  // pixels from the place that is shaded to what is looked at: eight on a ring, eight on a wider one
uniform vec2 rings;        // their radii, pixels
out vec4 pixel;
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(depths, 0) - 1;
  float depth = texelFetch(depths, here, 0).r, sum = 0.0;
  if (depth == 1.0) {  // nothing is there
    pixel = vec4(1);
    return;
  }
  for (int k = 0; k < 16; ++k) {
    ivec2 there = clamp(here + around[k], ivec2(0), last);
    sum += clamp((depth - texelFetch(depths, there, 0).r) * pixels / (k < 8 ? rings.x : rings.y), 0.0, 4.0);
  }
  pixel = vec4(texelFetch(colors, here, 0).rgb * exp(-strength * sum / 16.0), 1);
}`;

const kClay = [0.86, 0.82, 0.75], kStray = [0.86, 0.1, 0.1], kGrey = [0.78, 0.78, 0.78], kSlabless = 1e30;
const kMostThinned = 16;  // WebGL steps over 255 bytes at most
const kSurface = 0, kOutlier = 1, kRemoved = 2;  // RowKind of shown.h

class Painter {
  constructor(gl, points) {
    this.gl = gl;
    this.points = this.program(kPoints, kDisc, ['place', 'move', 'color', 'normal']);
    this.dome = this.program(kCorners, kEyeDome, []);
    const reaches = about.blocks.map(block => block.reach).sort((a, b) => a - b);
    this.reach = reaches[reaches.length >> 1];
    const buffer = data => {
      const made = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, made);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      return made;
    };
    this.buffers = {place: buffer(points.place), move: buffer(points.move), color: points.color && buffer(points.color)};
    this.sides = points.normal.map(normal => ({arrays: {}, normal: normal && buffer(normal), lit: normal ? 1 : 0,
                                               frame: gl.createFramebuffer(), textures: []}));
  }

  /** What a side is drawn from: every so many points. */
  arrays(side, every) {
    if (side.arrays[every]) return side.arrays[every];
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const attribute = (slot, from, bytes, type, normalized) => {
      if (!from) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, from);
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, 4, type, normalized, 4 * bytes * every, 0);
    };
    attribute(0, this.buffers.place, 2, gl.UNSIGNED_SHORT, false);
    attribute(1, this.buffers.move, 1, gl.BYTE, false);
    attribute(2, this.buffers.color, 1, gl.UNSIGNED_BYTE, true);
    attribute(3, side.normal, 1, gl.BYTE, false);
    return side.arrays[every] = array;
  }

  program(vertex, fragment, attributes) {
    const gl = this.gl, made = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    attributes.forEach((name, slot) => gl.bindAttribLocation(made, slot, name));
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    const places = {};
    return {made, at: name => name in places ? places[name] : places[name] = gl.getUniformLocation(made, name)};
  }

  /** Pictures of the canvas' size to draw the sides into. */
  resize(width, height) {
    const gl = this.gl;
    if (this.width === width && this.height === height) return;
    [this.width, this.height] = [width, height];
    for (const side of this.sides) {
      side.textures.forEach(texture => gl.deleteTexture(texture));
      gl.bindFramebuffer(gl.FRAMEBUFFER, side.frame);
      side.textures = [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]].map(([format, slot]) => {
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, slot, gl.TEXTURE_2D, texture, 0);
        return texture;
      });
    }
  }

  /** Draws what `state` (controls.js) says; `dense`: pixels of the canvas per pixel of the screen. Returns how long it took,
      milliseconds. */
  draw(state, dense) {
    const gl = this.gl, scale = camera.scale * dense, border = Math.round(state.slider * this.width), start = performance.now();
    // Wider than the points, whose own outlines say nothing.
    const size = Math.min(24, this.reach * scale * state.size);
    const rings = [Math.round(Math.max(1.5 * dense, 0.6 * size)), Math.round(Math.max(4 * dense, 1.2 * size))];
    const depthRange = 2.1 * about.radius || 1;
    gl.enable(gl.SCISSOR_TEST);
    gl.viewport(0, 0, this.width, this.height);
    // What eye-dome lighting looks at beyond the border is drawn too: either side is as if it were alone.
    const parts = [[0, border, rings[1]], [border, this.width, -rings[1]]];
    this.sides.forEach((side, which) => {
      const [from, to, margin] = parts[which];
      if (from === to) return;
      gl.bindFramebuffer(gl.FRAMEBUFFER, side.frame);
      const low = Math.max(0, from + Math.min(0, margin)), wide = to - from + rings[1];
      gl.scissor(low, 0, wide, this.height);
      this.drawPoints(state, which, scale, depthRange, dense, [low, low + wide]);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.scissor(from, 0, to - from, this.height);
      this.drawDome(side, state, 2 * depthRange * scale, rings);
    });
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));  // waits until it is done
    return performance.now() - start;
  }

  /** Whether a block may have points in these columns of the picture. */
  inSight(block, scale, {right, up}, [low, high]) {
    const away = block.origin.map((x, axis) => x + 32768 * block.step - camera.target[axis]);
    const radius = (1.8 * 32768 * block.step + 1.8 * 128 * block.unit) * scale + 64;
    const x = this.width / 2 + dot(away, right) * scale, y = dot(away, up) * scale;
    return x + radius > low && x - radius < high && Math.abs(y) < this.height / 2 + radius;
  }

  drawPoints(state, which, scale, depthRange, dense, columns) {
    const gl = this.gl, {made, at} = this.points, side = this.sides[which], axes = camera.axes();
    const every = state.every;
    // Few of many have the place of all. In a slab the points lie side by side: small, or they hide how they scatter.
    const larger = state.size * Math.sqrt(every) * (state.slabHalf < kSlabless ? 0.35 : 1);
    gl.useProgram(made);
    gl.bindVertexArray(this.arrays(side, every));
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (const [name, value] of Object.entries({...axes, target: camera.target, slab: state.slab})) gl.uniform3fv(at(name), value);
    gl.uniform3fv(at('anchors'), about.scale.flatMap(rgb => [1, 3, 5].map(k => parseInt(rgb.slice(k, k + 2), 16) / 255)));
    gl.uniform2f(at('screen'), this.width, this.height);
    const lit = state.mode === 'shaded' ? side.lit : 0;
    for (const [name, value] of Object.entries({side: which, scale, depthRange, lit, top: about.top, slabAt: state.slabAt,
                                               slabHalf: state.slabHalf}))
      gl.uniform1f(at(name), value);
    for (const block of about.blocks) {
      if (block.kind !== kSurface && (!state.strays || block.kind === kRemoved && which === 1)) continue;
      if (!this.inSight(block, scale, axes, columns)) continue;
      const marked = state.mode === 'outliers' && block.kind !== kSurface;
      gl.uniform3fv(at('origin'), block.origin);
      gl.uniform1f(at('stride'), block.step);
      gl.uniform1f(at('unit'), block.unit);
      gl.uniform1f(at('reach'), marked ? Math.max(2 * block.reach, 5 * dense / scale) : block.reach * larger);
      gl.uniform1i(at('mode'), {shaded: 0, colors: 1, moves: 2, outliers: 0}[state.mode]);
      gl.uniform3fv(at('plain'), marked ? kStray : state.mode === 'outliers' ? kGrey : kClay);
      const first = Math.ceil(block.first / every);
      gl.drawArrays(gl.POINTS, first, Math.ceil((block.first + block.count) / every) - first);
    }
    gl.bindVertexArray(null);
  }

  drawDome(side, state, pixels, rings) {
    const gl = this.gl, {made, at} = this.dome;
    gl.useProgram(made);
    gl.disable(gl.DEPTH_TEST);
    side.textures.forEach((texture, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    });
    gl.uniform1i(at('colors'), 0);
    gl.uniform1i(at('depths'), 1);
    gl.uniform1f(at('pixels'), pixels);
    const sliced = state.slabHalf < kSlabless;  // points beside each other are no shape
    gl.uniform1f(at('strength'), sliced ? 0.25 : state.mode === 'shaded' ? 1.1 : 0.7);
    const around = [...Array(16).keys()].flatMap(k => {
      const radius = rings[k >> 3], angle = Math.PI / 4 * (k + 0.5 * (k >> 3));
      return [Math.round(radius * Math.cos(angle)), Math.round(radius * Math.sin(angle))];
    });
    gl.uniform2iv(at('around'), around);
    gl.uniform2f(at('rings'), ...rings);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
