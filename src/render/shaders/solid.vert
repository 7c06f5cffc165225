// Balls, other bodies or the pen: a mesh, placed by a matrix without shear for each instance.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in mat4 model;  // of the instance, as are the next three
layout(location = 6) in vec3 instance_colour_a;
layout(location = 7) in vec3 instance_colour_b;
layout(location = 8) in int instance_self;

out vec3 local;         // in the surface's frame
out vec3 local_normal;
out vec3 body;          // in the mesh's own frame
flat out vec3 colour_a;
flat out vec3 colour_b;
flat out int self;      // index among the shadow casters, or -1

void main() {
  body = position;
  colour_a = instance_colour_a;
  colour_b = instance_colour_b;
  self = instance_self;
  local = (model * vec4(position, 1.0)).xyz;
  local_normal = mat3(model) * normal;
  gl_Position = view_projection * vec4(local, 1.0);
}
