// The pen: a dark satin shaft, a bright ring and a metal cone.
flat in vec3 colour_a;

in vec3 local;
in vec3 local_normal;
in vec3 body;
layout(location = 0) out vec4 out_colour;

void main() {
  vec3 n = normalize(local_normal);
  float cone = pen_cone.x;
  float metal = 1.0 - step(1.25 * cone, body.z) * (1.0 - step(0.96 * pen_direction.w, body.z));
  Matter matter = Matter(mix(colour_a, vec3(0.28, 0.27, 0.25), metal), mix(0.38, 0.3, metal), mix(0.05, 0.45, metal));
  vec3 l = to_light(local);
  float seen = object_shadow(local, l, MAX_BALLS) * relief_shadow(local + n * texels.z, l);
  out_colour = vec4(film(lit(local, n, matter, seen, object_openness(local, n, -1))), 1.0);
}
