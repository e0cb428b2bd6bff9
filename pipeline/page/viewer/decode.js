'use strict';
// The points, as blocks.h has packed them.

const about = JSON.parse(document.getElementById('about').textContent);

/** The bytes behind base64 of gzip. */
async function unpacked(text) {
  const letters = atob(text);
  const packed = new Uint8Array(letters.length);
  for (let i = 0; i < packed.length; ++i) packed[i] = letters.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Planes of bytes to arrays of four numbers a point, which is what graphics cards read best. */
function decoded(bytes) {
  const n = about.shown;
  let at = 0;
  const plane = () => bytes.subarray(at, at += n);
  /** One byte a point from each of so many planes. */
  const rows = (planes, Kind) => {
    const out = new Kind(4 * n);
    for (let k = 0; k < planes; ++k) {
      const values = plane();
      for (let i = 0; i < n; ++i) out[4 * i + k] = values[i];
    }
    return out;
  };
  const place = new Uint16Array(4 * n);
  for (let axis = 0; axis < 3; ++axis) {
    const high = plane(), low = plane();
    let i = 0;
    for (const block of about.blocks) {
      let last = 0;
      for (const end = i + block.count; i < end; ++i) {
        const zigzag = high[i] << 8 | low[i];
        last += zigzag & 1 ? -(zigzag + 1 >> 1) : zigzag >> 1;
        place[4 * i + axis] = last;
      }
    }
  }
  return {
    place,
    move: rows(3, Int8Array),
    color: about.colors ? rows(3, Uint8Array) : null,
    normal: about.normals.map(there => there ? rows(2, Int8Array) : null)
  };
}

/** Block by block, the first point and what blocks.h says of it. */
let first = 0;
for (const block of about.blocks) {
  block.first = first;
  first += block.count;
}

/** Coordinates of the points in the units of the file, x y z after each other: side 0 is before, 1 after. */
function coordinates(points, side) {
  const out = new Float64Array(3 * about.shown);
  for (const block of about.blocks)
    for (let i = block.first; i < block.first + block.count; ++i)
      for (let axis = 0; axis < 3; ++axis)
        out[3 * i + axis] = about.centre[axis] + block.origin[axis] + block.step * points.place[4 * i + axis] +
                            side * block.unit * points.move[4 * i + axis];
  return out;
}
