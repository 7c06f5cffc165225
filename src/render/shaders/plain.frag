// A body of one colour, half matt.
flat in int self;  // index among the shadow casters, or -1
flat in vec3 colour_a;

in vec3 local;
in vec3 local_normal;
in vec3 body;
layout(location = 0) out vec4 out_colour;

void main() {
  vec3 n = normalize(local_normal);
  Matter matter = Matter(colour_a, 0.4, 0.045);
  vec3 l = to_light(local);
  float seen = object_shadow(local, l, self) * relief_shadow(local + n * texels.z, l);
  float open = object_openness(local, n, self) * mix(0.4, 1.0, smoothstep(-0.6, 0.5, n.z));
  out_colour = vec4(film(lit(local, n, matter, seen, open)), 1.0);
}
