// A beach ball: six segments of two colours that meet in caps, so that any rotation is visible.
flat in int self;  // index among the shadow casters, or -1
flat in vec3 colour_a;
flat in vec3 colour_b;

in vec3 local;
in vec3 local_normal;
in vec3 body;
layout(location = 0) out vec4 out_colour;

// A step at 0 that is as wide as a sample.
float edge(float x, float width) { return clamp(0.5 + x / max(width, 1e-5), 0.0, 1.0); }

void main() {
  vec3 n = normalize(local_normal);
  vec3 b = normalize(body);
  // sin(3 phi) of the segments, times sin(theta)^3 so that it is smooth at the poles.
  float gores = b.y * (3.0 * b.x * b.x - b.y * b.y);
  float cap = abs(b.z) - 0.94;
  float tone = max(edge(gores, fwidth(gores)), edge(cap, fwidth(cap)));
  Matter matter = Matter(mix(colour_a, colour_b, tone), 0.28, 0.045);
  vec3 l = to_light(local);
  float seen = object_shadow(local, l, self) * relief_shadow(local + n * texels.z, l);
  // Near the contact the surface below hides the lower half of the ambient light.
  float open = object_openness(local, n, self) * mix(0.35, 1.0, smoothstep(-0.6, 0.5, n.z));
  out_colour = vec4(film(lit(local, n, matter, seen, open)), 1.0);
}
