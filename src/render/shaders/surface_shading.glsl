// Shading of a visible point of the surface: colour, normals at the footprint of a sample, and ambient occlusion.
uniform sampler2D normals;  // n' = (511 n + 512) / 1023; mipmapped
uniform sampler2D colour;   // linear light, mipmapped
uniform int self_caster;    // shadow caster that the surface belongs to, or -1

// Ambient occlusion of p by the relief: how far p lies below the mean height around it, at two distances.
float relief_openness(vec3 p, bool is_relief) {
  float covered = 0.0;
  // llvmpipe runs both sides of an `if`; a loop of no iterations costs nothing.
  for (int k = 0; k < (is_relief ? 2 : 0); ++k) {
    float radius = size.z * (k == 0 ? 0.6 : 1.8);
    covered += max(mean_height(p.xy, 2.0 * radius) - p.z, 0.0) / radius;
  }
  return exp(-1.5 * covered);
}

vec3 colour_at(vec2 uv, float footprint) {
  vec2 texel = size.xy / vec2(textureSize(colour, 0));
  vec3 mapped = textureLod(colour, uv, max(log2(footprint / max(texel.x, texel.y)), 0.0)).rgb;
  return texels.w == 0.0 ? material.rgb : mapped;
}

// The map's normal, and in w how much rougher than one texel a sample of that footprint looks: normals that disagree
// within it make the surface rougher (Toksvig 2005) instead of sparkling.
vec4 mapped_normal(vec2 uv, float footprint) {
  vec4 result = vec4(0.0, 0.0, 1.0, 0.0);
  for (int k = 0; k < (RELIEF ? 1 : min(count.z, 1)); ++k) {
    vec3 mean = (textureLod(normals, uv, max(log2(footprint / texels.z), 0.0)).xyz * 1023.0 - 512.0) / 511.0;
    float agreement = clamp(length(mean), 0.5, 1.0);
    result = vec4(mean / max(length(mean), 1e-4), 0.5 * (1.0 - agreement) / agreement);
  }
  return result;
}

// Where the slab is cut, the texture's colour fades to plaster over a short depth.
Matter wall_matter(vec3 skin, float under) {
  vec3 plaster = vec3(dot(skin, vec3(0.3, 0.5, 0.2))) * vec3(0.62, 0.58, 0.54) + 0.03;
  return Matter(mix(skin * 0.8, plaster, smoothstep(0.0, size.w * 0.5, under)), 0.9, 0.03);
}

// A point of the relief, or of a wall of the slab.
struct Spot {
  vec3 p, n;            // position and normal
  vec3 q;               // p in the texture: metres along u and v, and height; p itself for a slab
  vec3 q_normal;        // n in the texture
  vec3 q_light;         // towards the light in the texture, unit
  float spread;         // see mapped_normal
  bool is_wall;
};

// The light from there towards the eye.
vec3 surface_light(Spot s, float footprint) {
  bool is_relief = RELIEF && !s.is_wall;
  vec2 uv = s.q.xy / size.xy;
  float under = 0.0;
  for (int k = 0; k < (s.is_wall ? 1 : 0); ++k) {
    uv = clamp(uv, 0.5 / texels.xy, 1.0 - 0.5 / texels.xy);
    under = (RELIEF ? height(s.q.xy) : 0.0) - s.q.z;
  }
  vec3 skin = colour_at(uv, max(footprint, under));
  float square = material.w * material.w;
  Matter matter = Matter(skin, min(sqrt(sqrt(square * square + s.spread)), 1.0), 0.04);
  if (s.is_wall) matter = wall_matter(skin, under);
  vec3 l = to_light(s.p);
  bool faces_light = dot(s.n, l) > 0.0 && (s.is_wall || s.q_light.z > 0.0);
  float seen = faces_light ? object_shadow(s.p, l, self_caster) : 0.0;
  if (is_relief && seen > 0.0) seen *= relief_shadow(s.q + s.q_normal * 0.25 * cell_side(detail) * texels.z, s.q_light);
  float open = s.is_wall ? 0.75 : relief_openness(s.q, is_relief);
  return lit(s.p, s.n, matter, seen, open * object_openness(s.p, s.n, self_caster));
}
