#include <cmath>
#include <utility>

#include "contact/query.h"
#include "dynamics/world.h"
#include "intaglio/world.h"
#include "mesh/api.h"

namespace intaglio {

struct World::Impl {
  dynamics::World world;
  std::vector<double> mass;  // kg, of body k + 1
  std::vector<ContactEvent> events;
  double step;  // s
};

namespace {

Result<Material> chosen(const std::optional<MaterialChoice>& choice, const Surface& surface) {
  return choice ? choice->material() : Result<Material>(surface.material());
}

dynamics::World make_world(const WorldOptions& from, const Material& material) {
  dynamics::WorldOptions options;
  options.representation = from.representation;
  options.method = from.method;
  options.normal_method = from.normal_method;
  options.gravity = from.gravity;
  options.step = from.step;
  options.bodies_collide = from.bodies_collide;
  options.most_substeps = from.most_substeps;
  options.report_pairs = from.report_pairs;
  if (const auto* curved = std::get_if<CurvedSurface>(&from.floor))
    return dynamics::World(curved->impl().relief, material, options);
  return dynamics::World(std::get<Surface>(from.floor).impl().surface, material, options);
}

dynamics::Motion motion_of(Motion motion) {
  if (motion == Motion::fixed) return dynamics::Motion::fixed;
  return motion == Motion::driven ? dynamics::Motion::driven : dynamics::Motion::free;
}

}  // namespace

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(const WorldOptions& options) {
  if (!(options.step > 0) || !std::isfinite(options.step))
    return fail("WorldOptions::step", "is not above 0 s", "1.0 / 480 is usual");
  const auto* curved = std::get_if<CurvedSurface>(&options.floor);
  const auto material =
      chosen(options.floor_material, curved != nullptr ? curved->surface() : std::get<Surface>(options.floor));
  if (!material) return tl::unexpected(material.error());
  return World(std::make_unique<Impl>(Impl{make_world(options, *material), {}, {}, options.step}));
}

Result<BodyId> World::add(const Shape& shape, const BodyOptions& options) {
  const auto material = options.material.material();
  if (!material) return tl::unexpected(material.error());
  if (!contact::has_size(shape))
    return fail("World::add", "the shape has no size", "every side or radius must be finite and above 0 m");
  if (!options.faces.empty() && !std::holds_alternative<Box>(shape))
    return fail("World::add", "a body with faces is not a Box", "give other shapes a skin");
  dynamics::ShapeBody body;
  body.shape = shape;
  for (const Surface& face : options.faces) body.faces.push_back(face.impl().surface);
  if (options.skin) body.skin = options.skin->impl().relief;
  body.material = *material;
  body.pose = {options.position, options.orientation};
  body.velocity = options.velocity;
  body.angular_velocity = options.angular_velocity;
  body.motion = motion_of(options.motion);
  if (!contact::is_rigid(body.pose) || !body.velocity.allFinite() || !body.angular_velocity.allFinite())
    return fail("World::add", "a position, orientation or velocity is not finite");
  const BodyId id = impl_->world.add(body);
  impl_->mass.push_back(body.mass());
  if ((impl_->world.status(id) & dynamics::not_simulated) != 0 && options.skin)
    return fail("World::add", "the skin encloses no volume", "its mesh must be closed, triangles facing outwards");
  return id;
}

Result<BodyId> World::add_ground(const Surface& surface, const GroundOptions& options) {
  const auto material = chosen(options.material, surface);
  if (!material) return tl::unexpected(material.error());
  return impl_->world.add_surface(surface.impl().surface, *material);
}

Result<BodyId> World::add_ground(const CurvedSurface& surface, const GroundOptions& options) {
  const auto material = chosen(options.material, surface.surface());
  if (!material) return tl::unexpected(material.error());
  return impl_->world.add_surface(surface.impl().relief, *material, options.thickness);
}

void World::step() {
  impl_->world.step();
  const auto events = impl_->world.events();
  impl_->events.assign(events.begin(), events.end());
}

void World::run(double seconds) {
  impl_->events.clear();
  // A millionth of a step is rounding, not one step more.
  const auto steps = std::int64_t(std::ceil(seconds / impl_->step - 1e-6));
  for (std::int64_t k = 0; k < steps; ++k) {
    impl_->world.step();
    const auto events = impl_->world.events();
    impl_->events.insert(impl_->events.end(), events.begin(), events.end());
  }
}

std::span<const ContactEvent> World::events() const {
  return impl_->events;
}
double World::time() const {
  return impl_->world.time();
}

void World::push(BodyId body, const Vec3& impulse) {
  impl_->world.push(body, impulse);
}
void World::push(BodyId body, const Vec3& impulse, const Vec3& point) {
  impl_->world.push(body, impulse, point);
}
void World::put(BodyId body, const Pose& pose, const Vec3& velocity, const Vec3& angular_velocity) {
  impl_->world.put(body, pose, velocity, angular_velocity);
}
void World::drive(BodyId body, const Pose& pose) {
  impl_->world.drive(body, pose);
}

std::size_t World::body_count() const {
  return impl_->world.body_count();
}
Pose World::pose(BodyId body) const {
  return impl_->world.drawn_pose(body);
}
Pose World::simulated_pose(BodyId body) const {
  return impl_->world.pose(body);
}
Vec3 World::velocity(BodyId body) const {
  return impl_->world.velocity(body);
}
Vec3 World::angular_velocity(BodyId body) const {
  return impl_->world.angular_velocity(body);
}
double World::mass(BodyId body) const {
  return impl_->mass[body - 1];
}
unsigned World::status(BodyId body) const {
  return impl_->world.status(body);
}
double World::momentum_residual() const {
  return impl_->world.momentum_residual();
}

}  // namespace intaglio
