// The textured slab: finds where the view ray meets the relief, or the cut wall of the slab, and lights that point.
in vec3 local;
layout(location = 0) out vec4 out_colour;

struct Hit {
  vec3 p;
  bool wall;
  vec3 wall_normal;
};

// Where the ray meets the slab; discards the fragment when the ray leaves through a side, above the relief.
Hit meet_slab(vec3 origin, vec3 direction) {
  vec3 safe = mix(direction, vec3(1e-9), lessThan(abs(direction), vec3(1e-9)));
  vec3 a = (vec3(0.0, 0.0, -size.w) - origin) / safe;
  vec3 b = (vec3(size.xy, 0.0) - origin) / safe;
  vec3 near = min(a, b);
  vec3 far = max(a, b);
  float from = max(max(near.x, near.y), max(near.z, 0.0));
  float to = min(min(far.x, far.y), far.z);
  vec3 entry = origin + from * direction;
  detail = detail_for(eye.w * from);
  vec3 normal = from > 0.0 ? -sign(direction) * vec3(equal(vec3(from), near)) : -direction;
  // A ray that enters through the top plane starts above the relief; no test needed.
  bool from_top = from == near.z && direction.z < 0.0;
  if (from_top) entry.z = 0.0;
  float top = RELIEF ? height(entry.xy) : 0.0;
  if (!from_top && entry.z <= top) return Hit(entry, true, normal);
  if (!RELIEF) return Hit(entry, false, vec3(0.0));
  // A descending ray that leaves the layer's bottom is below the relief.
  if (direction.z < 0.0) to = min(to, (-1.001 * size.z - 1e-6 - origin.z) / direction.z);
  float t = march(origin, direction, from, to);
  if (t < 0.0) discard;
  return Hit(origin + t * direction, false, vec3(0.0));
}

void main() {
  vec3 direction = normalize(local - eye.xyz);
  Hit hit = meet_slab(eye.xyz, direction);
  float footprint = eye.w * distance(hit.p, eye.xyz);
  vec4 normal = hit.wall ? vec4(hit.wall_normal, 0.0) : mapped_normal(hit.p.xy / size.xy, footprint);
  Spot spot = Spot(hit.p, normal.xyz, hit.p, normal.xyz, to_light(hit.p), normal.w, hit.wall);
  out_colour = vec4(film(surface_light(spot, footprint)), 1.0);
  gl_FragDepth = window_depth(hit.p);
}
