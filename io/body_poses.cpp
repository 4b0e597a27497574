#include "io/body_poses.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/vector_json.h"

#include <nlohmann/json.hpp>

namespace smelt {

namespace {

using nlohmann::ordered_json;

Vec3 to_vector(const ordered_json& json) {
  if (!json.is_array() || json.size() != 3)
    throw nlohmann::json::other_error::create(501, "three numbers are wanted", nullptr);
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace

void write_body_poses(const std::filesystem::path& path, int frame, double time, const std::vector<BodyPose>& bodies) {
  ordered_json list = ordered_json::array();
  for (const BodyPose& body : bodies) {
    ordered_json rows = ordered_json::array();
    for (int row = 0; row < 3; ++row) rows.push_back(vector_json(body.pose.rotation.row(row)));
    list.push_back({{"collider", body.collider},
                    {"rotation", rows},
                    {"translation_m", vector_json(body.pose.translation)},
                    {"centre_m", vector_json(body.centre)},
                    {"velocity_m_s", vector_json(body.velocity)},
                    {"angular_velocity_rad_s", vector_json(body.angular_velocity)}});
  }
  const ordered_json root = {{"frame", frame}, {"time_s", time}, {"bodies", list}};
  write_file_atomically(path, root.dump(1) + "\n");
}

std::vector<BodyPose> read_body_poses(const std::filesystem::path& path) {
  std::vector<BodyPose> bodies;
  try {
    const ordered_json root = ordered_json::parse(read_file(path));
    for (const ordered_json& entry : root.at("bodies")) {
      BodyPose body;
      body.collider = entry.at("collider").get<int>();
      for (int row = 0; row < 3; ++row)
        body.pose.rotation.row(row) = to_vector(entry.at("rotation").at(static_cast<std::size_t>(row)));
      body.pose.translation = to_vector(entry.at("translation_m"));
      body.centre = to_vector(entry.at("centre_m"));
      body.velocity = to_vector(entry.at("velocity_m_s"));
      body.angular_velocity = to_vector(entry.at("angular_velocity_rad_s"));
      bodies.push_back(body);
    }
  } catch (const nlohmann::json::exception& error) {
    fail("{}: not a file of rigid bodies as smelt writes it ({}); simulate the frame again", path.string(),
         error.what());
  }
  return bodies;
}

}  // namespace smelt
