// Shading: GGX with Schlick's Fresnel under one light and a two-tone sky, then the film curve.

const float PI = 3.14159265;

// Ambient light from a direction.
vec3 sky_light(vec3 direction) { return mix(ground.rgb, sky.rgb, smoothstep(-1.0, 1.0, direction.z)); }

// Microfacet reflection times cos, Trowbridge-Reitz with the joint Smith term of Hammon 2017.
float specular_lobe(float n_h, float n_v, float n_l, float roughness) {
  float a = roughness * roughness;
  float a2 = a * a;
  float d = n_h * n_h * (a2 - 1.0) + 1.0;
  return n_l * a2 / (2.0 * PI * d * d * mix(2.0 * n_l * n_v, n_l + n_v, a) + 1e-6);
}

float fifth(float x) { return x * x * x * x * x; }

struct Matter {
  vec3 colour;      // linear, diffuse
  float roughness;
  float reflectance;  // at normal incidence
};

// p: point; n: shading normal; seen, open: visible fractions of the light and of the sky.
vec3 lit(vec3 p, vec3 n, Matter matter, float seen, float open) {
  vec3 v = normalize(eye.xyz - p);
  vec3 l = to_light(p);
  vec3 h = normalize(v + l);
  float n_v = clamp(abs(dot(n, v)), 1e-4, 1.0);
  float n_l = clamp(dot(n, l), 0.0, 1.0);
  float fresnel = matter.reflectance + (1.0 - matter.reflectance) * fifth(1.0 - clamp(dot(v, h), 0.0, 1.0));
  float lobe = specular_lobe(clamp(dot(n, h), 0.0, 1.0), n_v, n_l, matter.roughness);
  vec3 direct = seen * light_colour.rgb * (matter.colour / PI * n_l + fresnel * lobe);
  float gloss = 1.0 - matter.roughness;
  float rim = matter.reflectance + (max(gloss, matter.reflectance) - matter.reflectance) * fifth(1.0 - n_v);
  vec3 ambient = matter.colour * sky_light(n) + rim * gloss * sky_light(reflect(-v, n));
  return direct + open * ambient;
}

// Linear scene light to linear display light, with a shoulder for the highlights (Narkowicz 2015, fit to ACES).
vec3 film(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }
