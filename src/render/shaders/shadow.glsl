// Soft shadow terms: each returns the visible fraction of the light, 0..1. The light has a size, so a shadow's edge is
// as wide as the light appears from there: sharp at the contact, soft far from it.

// Fraction of a round light of half width `half_width` visible past an edge `clearance` away from its centre.
float seen_past(float clearance, float half_width) {
  return smoothstep(-half_width, half_width, clearance);
}

float ball_shadow(vec3 p, vec3 l, vec4 b) {
  vec3 to_centre = b.xyz - p;
  float along = dot(to_centre, l);
  float clearance = length(to_centre - along * l) - b.w;
  return along <= 0.0 ? 1.0 : seen_past(clearance, max(along * light_colour.w, 1e-5));
}

// Radius of the pen at a distance from its tip.
float pen_radius(float s) { return pen_tip.w * clamp(s / pen_cone.x, 0.0, 1.0); }

// By the ray's nearest approach to the pen's axis, since the pen is thin.
float pen_shadow(vec3 p, vec3 l) {
  vec3 w = p - pen_tip.xyz;
  vec3 axis = pen_direction.xyz;
  float cosine = dot(l, axis);
  float s = (dot(w, axis) - cosine * dot(w, l)) / max(1.0 - cosine * cosine, 1e-6);
  s = clamp(s, 0.0, pen_direction.w);
  float along = max(s * cosine - dot(w, l), 0.0);
  float apart = length(w + along * l - s * axis);
  return along <= 0.0 ? 1.0 : seen_past(apart - pen_radius(s), max(along * light_colour.w, 1e-5));
}

// All bodies except the shadow caster of index `self` (-1: no exception; MAX_BALLS: the pen).
float object_shadow(vec3 p, vec3 l, int self) {
  float seen = 1.0;
  for (int k = 0; k < count.x; ++k) {
    if (k != self) seen = min(seen, ball_shadow(p, l, ball[k]));
  }
  for (int k = 0; k < count.y; ++k) {
    if (self != MAX_BALLS) seen = min(seen, pen_shadow(p, l));
  }
  return seen;
}

// The fraction of the ambient light that bodies leave at p with normal n: the cosine-weighted part of the sky that a
// ball covers is exactly (r / d)^2 cos when all of it is above the horizon.
float object_openness(vec3 p, vec3 n, int self) {
  float open = 1.0;
  for (int k = 0; k < count.x; ++k) {
    vec3 to_centre = ball[k].xyz - p;
    float d2 = max(dot(to_centre, to_centre), ball[k].w * ball[k].w);
    float facing = clamp(0.5 + 0.5 * dot(n, to_centre) * inversesqrt(d2), 0.0, 1.0);
    if (k != self) open *= 1.0 - facing * facing * ball[k].w * ball[k].w / d2;
  }
  return open;
}

// Half width of the light at a distance `t`: an edge that is closer to its centre dims it. Clearance is measured across
// the ray, and the light is never narrower than the texels that hide it.
float half_width(vec3 l, float t) { return max(t * light_colour.w, 0.5 * cell_side(detail) * texels.z * l.z); }

// The visible fraction of a light along l from p to `to`, where the ray leaves the layer: by the smallest clearance at
// steps of equal length, one a texel unless that takes more than steps.z.
float relief_seen(vec3 p, vec3 l, float to) {
  int shadow_steps = clamp(int(ceil(length(l.xy) * to / (cell_side(detail) * texels.z))), 4, steps.z);
  float stride = to / float(shadow_steps);
  float seen = 1.0;
  for (int k = 0; k < shadow_steps && seen > 0.0; ++k) {
    float t = (float(k) + 0.5) * stride;
    vec3 q = p + t * l;
    seen = min(seen, seen_past((q.z - height(q.xy)) * length(l.xy), half_width(l, t)));
  }
  return seen;
}

// The relief's own shadow on p, traced towards the light until the ray leaves the layer.
float relief_shadow(vec3 p, vec3 l) {
  bool in_layer = p.z < 0.0 && all(greaterThanEqual(p.xy, vec2(0.0))) && all(lessThanEqual(p.xy, size.xy));
  if (!RELIEF || steps.z == 0 || !in_layer) return 1.0;
  if (l.z <= 0.0) return 0.0;
  vec2 side = mix(vec2(0.0), size.xy, step(0.0, l.xy));
  vec2 reach = mix((side - p.xy) / l.xy, vec2(1e20), lessThan(abs(l.xy), vec2(1e-6)));
  float to = min(-p.z / l.z, min(reach.x, reach.y));
  return relief_seen(p, l, to);
}
