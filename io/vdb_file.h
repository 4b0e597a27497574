#pragma once
// OpenVDB files as smelt writes them: whole, and the same bytes for the same content. Includes OpenVDB (slow to
// compile): for the .cpp files of io only.

#include <openvdb/Grid.h>

#include <filesystem>

namespace smelt {

/// Registers OpenVDB's grid and attribute types, once; to be called before the first grid is made.
void initialise_openvdb();

/// Writes `grids` to `path` and reads them back before the file takes its name, so that a full disk or a failing one is
/// an Error and never a truncated file. OpenVDB stamps a random UUID into each file; here it is a hash of the other
/// bytes, so equal content gives equal bytes. `creator` of the grids becomes "smelt". Throws Error with the path.
void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids);

/// All grids of a file, read completely. Throws Error with the path where it is missing, not an OpenVDB file,
/// truncated, or (for files from write_vdb) changed since.
openvdb::GridPtrVec read_vdb(const std::filesystem::path& path);

}  // namespace smelt
