// Exact search: descend a pyramid of the maximum z in blocks of cells, skip blocks that the ray passes above, and
// intersect ray and bilinear patch in the leaves (after Tevs, Ihrke & Seidel 2008, with their cells made bilinear).
// Cell (i, j) lies between vertices (i, j) and (i + 1, j + 1). Where a sample is larger than a texel, the leaves are
// blocks of 2^detail x 2^detail cells, and the patch is that of the coarser field there.
uniform sampler2D bounds;  // level k: minimum depth fraction in blocks of 2^(k + 1) x 2^(k + 1) cells

// How far a step overshoots into the next cell, in cells: more than the rounding of a coordinate, less than visible.
const float NUDGE = 2e-3;

float vertex(ivec2 at) { return -size.z * texelFetch(heights, at, detail).r; }

// The maximum z in a block of 2^level cells a side; level 1 and up.
float highest(vec2 block, int level) { return -size.z * texelFetch(bounds, ivec2(block), level - 1).r; }

// The first s in 0..1 at which p + s d is under the patch of a cell of the level `detail`, or 2. xy in cells of that
// level, z in metres.
//
// The height of the ray above the bilinear patch is h(s) = a s^2 + b s + c. With c > 0 the ray starts above, and the
// smallest positive root is 2c / (-b + sqrt(b^2 - 4ac)), whatever the sign of a: for a > 0 it is the nearer of two, for
// a < 0 the only positive one, and a = 0 gives -c / b. The usual form would divide by a; this one subtracts nearly equal
// numbers only when b > 0 and the root is far outside 0..1.
float meet_patch(vec3 p, vec3 d, ivec2 cell) {
  float z00 = vertex(cell);
  float z10 = vertex(cell + ivec2(1, 0));
  float z01 = vertex(cell + ivec2(0, 1));
  float z11 = vertex(cell + ivec2(1, 1));
  vec2 q = p.xy - vec2(cell);
  float along_s = z10 - z00;
  float along_t = z01 - z00;
  float twist = z11 - z10 - z01 + z00;
  float a = -twist * d.x * d.y;
  float b = d.z - along_s * d.x - along_t * d.y - twist * (q.x * d.y + q.y * d.x);
  float c = p.z - (z00 + along_s * q.x + along_t * q.y + twist * q.x * q.y);
  if (c <= 0.0) return 0.0;
  float discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0.0) return 2.0;
  float denominator = sqrt(discriminant) - b;
  return denominator > 0.0 ? 2.0 * c / denominator : 2.0;
}

// A walk along a ray, block by block. xy in cells, z in metres, t along the ray.
struct Walk {
  vec3 o, d;
  vec2 inverse, ahead;
  float nudge;  // in t
};

Walk walk(vec3 origin, vec3 direction) {
  vec3 scale = vec3(texels.xy / size.xy, 1.0);
  vec3 d = direction * scale;
  vec2 inverse = vec2(abs(d.x) > 1e-9 ? 1.0 / d.x : 1e20, abs(d.y) > 1e-9 ? 1.0 / d.y : 1e20);
  return Walk(origin * scale + vec3(0.5, 0.5, 0.0), d, inverse, step(0.0, d.xy), NUDGE / max(length(d.xy), 1e-6));
}

// The block of that level in which the walk is at t.
vec2 block_at(Walk w, float t, int level) { return floor((w.o.xy + (t + w.nudge) * w.d.xy) / float(1 << level)); }

// Where the walk leaves the block, at most `to`.
float leaves(Walk w, vec2 block, int level, float t, float to) {
  vec2 exits = ((block + w.ahead) * float(1 << level) - w.o.xy) * w.inverse;
  return min(min(exits.x > t ? exits.x : 1e20, exits.y > t ? exits.y : 1e20), to);
}

// The first t in from..to where origin + t * direction is under the relief, or -1.
float march(vec3 origin, vec3 direction, float from, float to) {
  Walk w = walk(origin, direction);
  int level = min(detail + 2, steps.w);
  vec3 to_cells = vec3(vec2(1.0 / cell_side(detail)), 1.0);
  float t = from;
  float hit = -1.0;
  // Two alternating loops, of blocks and of cells: in SIMD, lanes in one loop do not pay for the other.
  for (int k = 0; k < 512 && t < to && hit < 0.0; ++k) {
    for (; level > detail && t < to; ++k) {
      vec2 block = block_at(w, t, level);
      float t_exit = leaves(w, block, level, t, to);
      float bound = highest(block, level);
      float z_here = w.o.z + t * w.d.z;
      bool over = min(z_here, w.o.z + t_exit * w.d.z) > bound;
      // Only a descending ray goes from above the bound to below it.
      float down = z_here > bound ? min((bound - w.o.z) / w.d.z, t_exit) : t;
      t = over ? max(t_exit, t + w.nudge) : down;
      level = over ? min(level + 1, steps.w) : level - 1;
    }
    for (; level == detail && t < to && hit < 0.0; ++k) {
      vec2 cell = block_at(w, t, detail);
      float t_exit = leaves(w, cell, detail, t, to);
      float at = meet_patch((w.o + t * w.d) * to_cells, w.d * to_cells * (t_exit - t), ivec2(cell));
      hit = at <= 1.0 ? t + at * (t_exit - t) : hit;
      t = max(t_exit, t + w.nudge);
      level = block_at(w, t, detail + 1) == floor(0.5 * cell) ? detail : detail + 1;
    }
  }
  return hit;
}
