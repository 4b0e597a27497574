#include "io/vdb_summary.h"

#include "io/vdb_file.h"

#include <openvdb/openvdb.h>

namespace smelt {

std::vector<GridSummary> summarise_vdb(const std::filesystem::path& path) {
  std::vector<GridSummary> out;
  for (const auto& grid : read_vdb(path)) {
    GridSummary s;
    s.name = grid->getName();
    s.is_of_smelt = grid->getCreator() == "smelt";
    s.value_type = grid->valueType();
    s.grid_class = openvdb::GridBase::gridClassToString(grid->getGridClass());
    s.voxel_size = grid->voxelSize()[0];
    s.n_active = grid->activeVoxelCount();
    if (const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid))
      s.background = static_cast<double>(floats->background());
    if (s.n_active > 0) {
      const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
      for (const openvdb::Coord& corner : {box.min(), box.max()}) {
        const openvdb::Vec3d x = grid->indexToWorld(corner);
        s.bounds.extend(Vec3(x[0], x[1], x[2]));
      }
    }
    for (auto meta = grid->beginMeta(); meta != grid->endMeta(); ++meta)
      if (meta->first != "name" && meta->first != "class" && !meta->first.starts_with("file_"))
        s.metadata.emplace_back(meta->first, meta->second->str());
    out.push_back(std::move(s));
  }
  return out;
}

}  // namespace smelt
