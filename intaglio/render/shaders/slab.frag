// The textured slab: finds where the view ray meets the relief, or the cut wall of the slab, and lights that point.
uniform sampler2D relief;  // normal map in xyz, depth as a fraction of the greatest in w; mipmapped
uniform sampler2D colour;  // sRGB, mipmapped

in vec3 local;
layout(location = 0) out vec4 out_colour;

struct Hit {
  vec3 p;
  bool wall;
  vec3 wall_normal;
};

// Where the ray meets the slab's solid; discards the fragment when it leaves through a side, over the relief.
Hit meet_slab(vec3 origin, vec3 direction) {
  vec3 safe = mix(direction, vec3(1e-9), lessThan(abs(direction), vec3(1e-9)));
  vec3 a = (vec3(0.0, 0.0, -size.w) - origin) / safe;
  vec3 b = (vec3(size.xy, 0.0) - origin) / safe;
  vec3 near = min(a, b);
  vec3 far = max(a, b);
  float from = max(max(near.x, near.y), max(near.z, 0.0));
  float to = min(min(far.x, far.y), far.z);
  vec3 entry = origin + from * direction;
  vec3 normal = from > 0.0 ? -sign(direction) * vec3(equal(vec3(from), near)) : -direction;
  // A ray that comes in through the top plane starts above the relief without being asked.
  bool from_top = from == near.z && direction.z < 0.0;
  if (from_top) entry.z = 0.0;
  float top = count.z == 2 ? height(entry.xy) : 0.0;
  if (!from_top && entry.z <= top) return Hit(entry, true, normal);
  if (count.z != 2) return Hit(entry, false, vec3(0.0));
  // A falling ray is under the relief when it is through the layer.
  if (direction.z < 0.0) to = min(to, (-1.001 * size.z - 1e-6 - origin.z) / direction.z);
  float t = march(origin, direction, from, to);
  if (t < 0.0) discard;
  return Hit(origin + t * direction, false, vec3(0.0));
}

// The share of the sky over p: how far it lies below the mean height around it, at two distances.
float relief_openness(vec2 uv, float z) {
  float covered = 0.0;
  for (int k = 0; k < 2; ++k) {
    float radius = size.z * (k == 0 ? 0.6 : 1.8);
    float mean = -size.z * textureLod(relief, uv, max(log2(2.0 * radius / texels.z), 0.0)).w;
    covered += max(mean - z, 0.0) / radius;
  }
  return exp(-1.5 * covered);
}

vec3 colour_at(vec2 uv, float footprint) {
  if (texels.w == 0.0) return material.rgb;
  vec2 texel = size.xy / vec2(textureSize(colour, 0));
  return textureLod(colour, uv, max(log2(footprint / max(texel.x, texel.y)), 0.0)).rgb;
}

vec3 relief_colour(vec3 p, float footprint) {
  vec2 uv = p.xy / size.xy;
  Matter matter = Matter(colour_at(uv, footprint), material.w, 0.04);
  vec3 n = vec3(0.0, 0.0, 1.0);
  float open = 1.0;
  if (count.z != 0) {
    vec3 mean = textureLod(relief, uv, max(log2(footprint / texels.z), 0.0)).xyz;
    // Normals that disagree within a pixel make a rougher surface (Toksvig 2005), not a sparkling one.
    float agreement = clamp(length(mean), 0.5, 1.0);
    n = mean / max(length(mean), 1e-4);
    matter.roughness = sqrt(sqrt(pow(matter.roughness, 4.0) + 0.5 * (1.0 - agreement) / agreement));
    matter.roughness = min(matter.roughness, 1.0);
  }
  if (count.z == 2) open = relief_openness(uv, p.z);
  vec3 l = to_light(p);
  float seen = min(dot(n, l), l.z) > 0.0 ? object_shadow(p, l, -1) : 0.0;
  if (seen > 0.0) seen *= relief_shadow(p + n * 0.25 * texels.z, l);
  return lit(p, n, matter, seen, open * object_openness(p, n, -1));
}

// Where the slab is cut, the texture's own colour runs a little way in and fades to plain plaster.
vec3 wall_colour(vec3 p, vec3 n, float footprint) {
  vec2 inside = clamp(p.xy / size.xy, 0.5 / texels.xy, 1.0 - 0.5 / texels.xy);
  float under = (count.z == 2 ? height(p.xy) : 0.0) - p.z;
  vec3 skin = colour_at(inside, max(footprint, under));
  vec3 plaster = vec3(dot(skin, vec3(0.3, 0.5, 0.2))) * vec3(0.62, 0.58, 0.54) + 0.03;
  Matter matter = Matter(mix(skin * 0.8, plaster, smoothstep(0.0, size.w * 0.5, under)), 0.9, 0.03);
  vec3 l = to_light(p);
  float seen = dot(n, l) > 0.0 ? object_shadow(p, l, -1) : 0.0;
  return lit(p, n, matter, seen, 0.75 * object_openness(p, n, -1));
}

void main() {
  vec3 direction = normalize(local - eye.xyz);
  Hit hit = meet_slab(eye.xyz, direction);
  float footprint = eye.w * distance(hit.p, eye.xyz);
  vec3 radiance = hit.wall ? wall_colour(hit.p, hit.wall_normal, footprint) : relief_colour(hit.p, footprint);
  out_colour = vec4(film(radiance), 1.0);
  gl_FragDepth = window_depth(hit.p);
}
