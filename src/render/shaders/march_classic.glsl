// Relief mapping's search: linear steps until below the relief, then bisection (Policarpo, Oliveira & Comba 2005).
// Features thinner than a step can be missed.

// The first t in from..to where origin + t * direction is under the relief, or -1.
float march(vec3 origin, vec3 direction, float from, float to) {
  float stride = (to - from) / float(steps.x);
  float above = from;
  for (int k = 0; k <= steps.x; ++k) {
    float t = from + float(k) * stride;
    vec3 p = origin + t * direction;
    if (p.z <= height(p.xy)) {
      float below = t;
      for (int b = 0; b < steps.y; ++b) {
        float middle = 0.5 * (above + below);
        vec3 q = origin + middle * direction;
        if (q.z <= height(q.xy)) below = middle; else above = middle;
      }
      return 0.5 * (above + below);
    }
    above = t;
  }
  return -1.0;
}
