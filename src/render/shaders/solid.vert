// A ball or the pen: a mesh placed by a matrix without shear.
uniform mat4 model;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

out vec3 local;         // in the surface's frame
out vec3 local_normal;
out vec3 body;          // in the mesh's own frame

void main() {
  body = position;
  local = (model * vec4(position, 1.0)).xyz;
  local_normal = mat3(model) * normal;
  gl_Position = view_projection * vec4(local, 1.0);
}
