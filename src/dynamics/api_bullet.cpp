#include "dynamics/textured_shape.h"
#include "intaglio/bullet.h"
#include "mesh/api.h"

namespace intaglio::bullet {

void enable(btCollisionDispatcher& dispatcher) {
  dynamics::register_algorithms(dispatcher);
}

SurfaceShape::SurfaceShape(const Surface& surface, const ShapeOptions& options)
    : impl_(std::make_unique<dynamics::TexturedShape>(
          surface.impl().surface,
          dynamics::ContactOptions{options.representation, options.method, options.normal_method},
          options.thickness)) {
  m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;
  m_collisionMargin = 0;
}

SurfaceShape::SurfaceShape(const CurvedSurface& surface, const ShapeOptions& options)
    : impl_(std::make_unique<dynamics::CurvedShape>(surface.impl().relief, options.thickness)) {
  m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;
  m_collisionMargin = 0;
}

SurfaceShape::~SurfaceShape() = default;

void SurfaceShape::calculateLocalInertia(btScalar mass, btVector3& inertia) const {
  impl_->calculateLocalInertia(mass, inertia);
}
void SurfaceShape::getAabb(const btTransform& transform, btVector3& low, btVector3& high) const {
  impl_->getAabb(transform, low, high);
}
void SurfaceShape::processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                                       const btVector3& high) const {
  impl_->processAllTriangles(callback, low, high);
}
void SurfaceShape::setLocalScaling(const btVector3& scaling) {
  impl_->setLocalScaling(scaling);
}
const btVector3& SurfaceShape::getLocalScaling() const {
  return impl_->getLocalScaling();
}

}  // namespace intaglio::bullet
