#include "apps/spinaltap-planner/scene/bone_chunks.h"

#include <tbb/parallel_for.h>
#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "apps/spinaltap-planner/scene/surface_look.h"

namespace spinaltap {
namespace {

constexpr int kBlocksAlongChunk = 4;

std::array<int, 3> chunk_of(const std::array<int, 3>& block) {
  std::array<int, 3> chunk{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int rest = (block[axis] % kBlocksAlongChunk + kBlocksAlongChunk) % kBlocksAlongChunk;
    chunk[axis] = (block[axis] - rest) / kBlocksAlongChunk;
  }
  return chunk;
}

struct ColouredBlock {
  std::shared_ptr<const SurfaceBlock> surface;
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< of its vertices; empty until they are made
};

}  // namespace

struct BoneChunks::Chunk {
  std::map<std::array<int, 3>, ColouredBlock> blocks;
  bool is_changed = true;
  double drawn_opacity = 1.0;
  vtkNew<vtkPolyData> mesh;
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;

  Chunk() {
    mapper->SetInputData(mesh);
    mapper->StaticOn();
    actor->SetMapper(mapper);
    actor->GetProperty()->BackfaceCullingOn();
    light_softly(*actor);
  }

  void set_block(const std::array<int, 3>& block, const std::shared_ptr<const SurfaceBlock>& surface) {
    if (surface == nullptr) {
      is_changed |= blocks.erase(block) > 0;
      return;
    }
    ColouredBlock& kept = blocks[block];
    if (kept.surface == surface) return;
    kept = {surface, {}};
    is_changed = true;
  }

  void colour_blocks(const BoneModel& bone) {
    for (auto& [place, block] : blocks) {
      if (block.colours.empty()) block.colours = surface_colours(bone, *block.surface);
    }
  }

  void set_opacity(double opacity) {
    if (opacity == drawn_opacity) return;
    const bool was_glass = drawn_opacity < 1.0;
    const bool is_glass = opacity < 1.0;
    // Another shader is compiled, so only where it must be.
    if (is_glass != was_glass) is_glass ? light_as_glass(*actor) : light_softly(*actor);
    actor->GetProperty()->SetOpacity(opacity);
    actor->GetProperty()->SetBackfaceCulling(!is_glass);
    drawn_opacity = opacity;
  }

  void make_mesh();
};

void BoneChunks::Chunk::make_mesh() {
  vtkIdType vertices = 0;
  vtkIdType triangles = 0;
  for (const auto& [place, block] : blocks) {
    vertices += static_cast<vtkIdType>(block.surface->vertices_mm.size());
    triangles += static_cast<vtkIdType>(block.surface->triangles.size());
  }
  vtkNew<vtkFloatArray> places;
  vtkNew<vtkFloatArray> normals;
  vtkNew<vtkUnsignedCharArray> colours;
  vtkNew<vtkTypeInt32Array> corners;
  places->SetNumberOfComponents(3);
  normals->SetNumberOfComponents(3);
  colours->SetNumberOfComponents(3);
  float* place = places->WritePointer(0, 3 * vertices);
  float* normal = normals->WritePointer(0, 3 * vertices);
  unsigned char* colour = colours->WritePointer(0, 3 * vertices);
  vtkTypeInt32* corner = corners->WritePointer(0, 3 * triangles);
  vtkTypeInt32 first = 0;
  for (const auto& [key, block] : blocks) {
    const SurfaceBlock& surface = *block.surface;
    for (std::size_t n = 0; n < surface.vertices_mm.size(); ++n) {
      place = std::copy_n(surface.vertices_mm[n].data(), 3, place);
      normal = std::copy_n(surface.normals[n].data(), 3, normal);
      colour = std::copy_n(block.colours[n].data(), 3, colour);
    }
    for (const std::array<std::uint16_t, 3>& triangle : surface.triangles) {
      for (const std::uint16_t index : triangle) *corner++ = first + static_cast<vtkTypeInt32>(index);
    }
    first += static_cast<vtkTypeInt32>(surface.vertices_mm.size());
  }
  vtkNew<vtkPoints> points;
  points->SetData(places);
  vtkNew<vtkCellArray> cells;
  cells->SetData(3, corners);
  mesh->SetPoints(points);
  mesh->SetPolys(cells);
  mesh->GetPointData()->SetNormals(normals);
  mesh->GetPointData()->SetScalars(colours);
  mesh->Modified();
}

BoneChunks::BoneChunks(vtkRenderer& renderer) : renderer_(renderer) {}

BoneChunks::~BoneChunks() = default;

void BoneChunks::set_bone(const BoneModel* bone) {
  for (const auto& [place, chunk] : chunks_) renderer_.RemoveActor(chunk->actor);
  chunks_.clear();
  drawn_opacity_ = -1.0;
  bone_.reset();
  if (bone != nullptr) bone_ = before_drilling(*bone);
}

void BoneChunks::update(std::span<const SurfaceUpdate> updates) {
  for (const SurfaceUpdate& changed : updates) {
    std::unique_ptr<Chunk>& chunk = chunks_[chunk_of(changed.block)];
    if (chunk == nullptr) {
      chunk = std::make_unique<Chunk>();
      renderer_.AddActor(chunk->actor);
    }
    chunk->set_block(changed.block, changed.surface);
  }
}

void BoneChunks::set_opacity(double opacity) { opacity_ = opacity; }

bool BoneChunks::prepare() {
  std::vector<Chunk*> changed;
  for (const auto& [place, chunk] : chunks_) {
    if (chunk->is_changed) changed.push_back(chunk.get());
  }
  tbb::parallel_for(std::size_t{0}, changed.size(), [&](std::size_t n) { changed[n]->colour_blocks(*bone_); });
  for (Chunk* chunk : changed) {
    chunk->make_mesh();
    chunk->is_changed = false;
  }
  if (changed.empty() && opacity_ == drawn_opacity_) return false;
  drawn_opacity_ = opacity_;
  for (const auto& [place, chunk] : chunks_) {
    chunk->actor->SetVisibility(opacity_ > 0.0 && !chunk->blocks.empty());
    chunk->set_opacity(opacity_);
  }
  return true;
}

}  // namespace spinaltap
