// The slab with its relief as a displaced mesh, for comparison: the texture's colours, the mesh's own normals.
in vec3 local;
in vec3 local_normal;
in vec3 body;
layout(location = 0) out vec4 out_colour;

void main() {
  float footprint = eye.w * distance(local, eye.xyz);
  detail = detail_for(footprint);
  bool wall = local_normal.z < 1e-6;
  vec3 n = normalize(local_normal);
  out_colour = vec4(film(surface_light(Spot(local, n, local, n, to_light(local), 0.0, wall), footprint)), 1.0);
}
