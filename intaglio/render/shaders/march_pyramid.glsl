// Exact search: descend a pyramid of the highest z in blocks of cells, skip blocks that the ray passes over, and solve the
// quadratic of ray and bilinear patch in the leaves (after Tevs, Ihrke & Seidel 2008, with their cells made bilinear).
// Cell (i, j) lies between the centres of texels (i, j) and (i + 1, j + 1) of the bordered height texture.
uniform sampler2D bounds;  // level k: highest z in blocks of 2^k x 2^k cells

// How far into the next cell a step goes, in cells: more than the rounding of a coordinate, less than can be seen.
const float NUDGE = 2e-3;

// Where in 0..1 of the step `d` from `p` the ray goes under the cell's patch, or 2. xy in cells, z in metres.
float meet_patch(vec3 p, vec3 d, ivec2 cell) {
  float z00 = texelFetch(heights, cell, 0).r;
  float z10 = texelFetch(heights, cell + ivec2(1, 0), 0).r;
  float z01 = texelFetch(heights, cell + ivec2(0, 1), 0).r;
  float z11 = texelFetch(heights, cell + ivec2(1, 1), 0).r;
  vec2 q = p.xy - vec2(cell);
  float along_s = z10 - z00;
  float along_t = z01 - z00;
  float twist = z11 - z10 - z01 + z00;
  // Height of the ray over the patch: a x^2 + b x + c.
  float a = -twist * d.x * d.y;
  float b = d.z - along_s * d.x - along_t * d.y - twist * (q.x * d.y + q.y * d.x);
  float c = p.z - (z00 + along_s * q.x + along_t * q.y + twist * q.x * q.y);
  if (c <= 0.0) return 0.0;
  float discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0.0) return 2.0;
  // With c > 0 this form gives the smallest positive root whatever the sign of a, and never cancels.
  float denominator = sqrt(discriminant) - b;
  return denominator > 0.0 ? 2.0 * c / denominator : 2.0;
}

// The first t in from..to where origin + t * direction is under the relief, or -1.
float march(vec3 origin, vec3 direction, float from, float to) {
  vec3 scale = vec3(texels.xy / size.xy, 1.0);
  vec3 o = origin * scale + vec3(0.5, 0.5, 0.0);
  vec3 d = direction * scale;
  vec2 inverse = vec2(abs(d.x) > 1e-9 ? 1.0 / d.x : 1e20, abs(d.y) > 1e-9 ? 1.0 / d.y : 1e20);
  vec2 ahead = step(0.0, d.xy);
  float nudge = NUDGE / max(length(d.xy), 1e-6);
  int top = steps.w - 1;
  int level = min(2, top);
  float t = from;
  for (int k = 0; k < 512; ++k) {
    float block = float(1 << level);
    vec2 corner = floor((o.xy + (t + nudge) * d.xy) / block);
    vec2 exits = ((corner + ahead) * block - o.xy) * inverse;
    float t_exit = min(min(exits.x > t ? exits.x : 1e20, exits.y > t ? exits.y : 1e20), to);
    float bound = texelFetch(bounds, ivec2(corner), level).r;
    float z_exit = o.z + t_exit * d.z;
    float z_here = o.z + t * d.z;
    if (min(z_here, z_exit) > bound) {
      t = max(t_exit, t + nudge);
      level = min(level + 1, top);
    } else if (level > 0) {
      --level;
      if (z_here > bound) t = min((bound - o.z) / d.z, t_exit);  // only a falling ray gets here
    } else {
      float at = meet_patch(o + t * d, d * (t_exit - t), ivec2(corner));
      if (at <= 1.0) return t + at * (t_exit - t);
      t = max(t_exit, t + nudge);
    }
    if (t >= to) return -1.0;
  }
  return to;
}
