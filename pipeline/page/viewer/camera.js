// An orthographic camera that turns around what it looks at, upright.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => a.map(x => x / Math.hypot(...a));
const plus = (a, s, b) => a.map((x, k) => x + s * b[k]);

const camera = {
  target: [0, 0, 0],  // what is in the middle of the picture, relative to the page's origin
  turn: 0,            // around `up`, radians
  tilt: 0,            // above the horizon
  scale: 1,           // pixels of the screen per unit of the file

  /** Turns so that `toward` comes out of the picture. */
  look(toward) {
    const height = dot(unit(toward), this.up);
    this.tilt = Math.asin(Math.max(-1, Math.min(1, height)));
    if (Math.abs(height) < 0.9999) this.turn = Math.atan2(dot(toward, this.east), dot(toward, this.south));
  },
  /** Directions of the picture: to the right, up, out of it. */
  axes() {
    const level = plus(this.south.map(x => x * Math.cos(this.turn)), Math.sin(this.turn), this.east);
    const toward = plus(level.map(x => x * Math.cos(this.tilt)), Math.sin(this.tilt), this.up);
    const right = cross(this.up, level);
    return {right, up: cross(toward, right), toward};
  },
  /** Shifts the picture by so many pixels of the screen. */
  shift(x, y) {
    const {right, up} = this.axes();
    this.target = plus(plus(this.target, -x / this.scale, right), y / this.scale, up);
    const far = Math.hypot(...this.target) / about.radius;
    if (far > 1) this.target = this.target.map(x => x / far);
  },
  /** Goes nearer by a factor; the place at (x, y) pixels from the middle stays where it is. */
  near(factor, x, y) {
    const wanted = Math.max(this.smallest, Math.min(this.smallest * 1e5, this.scale * factor));
    const real = wanted / this.scale;
    this.scale = wanted;
    this.shift(-x * (real - 1), -y * (real - 1));
  },
  /** The first view: `some` points fill a picture of that size, but for a few at the edges. */
  home(some, width, height) {
    this.up = unit(about.up);
    this.east = unit(Math.abs(dot(unit(about.toward), this.up)) < 0.9999
      ? cross(this.up, about.toward) : cross(this.up, Math.abs(this.up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
    this.south = cross(this.east, this.up);
    this.look(about.toward);
    this.fit(some, width, height);
  },
  fit(some, width, height) {
    const {right, up, toward} = this.axes();
    const range = axis => {
      const along = Float64Array.from(some, p => dot(p, axis)).sort();
      const cut = Math.floor(along.length / 500);
      return [along[cut], along[along.length - 1 - cut]];
    };
    const [x, y, z] = [right, up, toward].map(range);
    const full = Math.min(width / (x[1] - x[0]), height / (y[1] - y[0])) / 1.12;
    this.scale = Number.isFinite(full) ? full : 1;
    this.smallest = this.scale / 20;
    this.target = [0, 0, 0];
    for (const [axis, [low, high]] of [[right, x], [up, y], [toward, z]])
      this.target = plus(this.target, (low + high) / 2, axis);
  }
};
