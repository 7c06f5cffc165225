// The relief of a curved base within one tetrahedron of its layer, where the view ray is straight in the texture, too.
in vec3 local;
flat in vec4 eye_weights;
flat in vec3 slope0, slope1, slope2, slope3;
flat in vec3 eye_texture;
flat in mat3 to_texture;
layout(location = 0) out vec4 out_colour;

// The ray's interval within the tetrahedron: from, to.
vec2 inside(vec3 direction) {
  vec4 rate = vec4(dot(slope0, direction), dot(slope1, direction), dot(slope2, direction), dot(slope3, direction));
  vec4 at = -eye_weights / mix(rate, vec4(1e-9), lessThan(abs(rate), vec4(1e-9)));
  vec4 enters = mix(vec4(0.0), at, greaterThan(rate, vec4(0.0)));
  vec4 leaves = mix(vec4(1e9), at, lessThan(rate, vec4(0.0)));
  return vec2(max(max(enters.x, enters.y), max(enters.z, enters.w)), min(min(leaves.x, leaves.y), min(leaves.z, leaves.w)));
}

void main() {
  vec3 direction = normalize(local - eye.xyz);
  vec3 along = to_texture * direction;
  vec2 range = inside(direction);
  if (range.x >= range.y) discard;
  float t = range.x;
  if (RELIEF) {
    detail = detail_for(eye.w * range.x);
    t = march(eye_texture, along, range.x, range.y);
    if (t < 0.0) discard;
  } else if (along.z >= 0.0 || eye_texture.z + range.x * along.z < -1e-3 * size.z) {
    discard;  // the base is not visible here
  }
  vec3 p = eye.xyz + t * direction;
  vec3 q = eye_texture + t * along;
  float footprint = eye.w * distance(p, eye.xyz);
  vec4 mapped = mapped_normal(q.xy / size.xy, footprint);
  vec3 n = normalize(mapped.xyz * to_texture);
  vec3 l = normalize(to_texture * to_light(p));
  out_colour = vec4(film(surface_light(Spot(p, n, q, mapped.xyz, l, mapped.w, false), footprint)), 1.0);
  gl_FragDepth = window_depth(p);
}
