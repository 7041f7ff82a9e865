// The navmesh's half-edge topology: OpenMesh with our precision and nothing more.
#pragma once

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

namespace forewalk::navmesh {

struct HalfEdgeTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3f;
  VertexAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};

using HalfEdgeMesh = OpenMesh::PolyMesh_ArrayKernelT<HalfEdgeTraits>;

}  // namespace forewalk::navmesh
