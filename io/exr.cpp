#include "io/exr.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/extension.h"
#include "io/radiance_hdr.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <algorithm>
#include <string_view>

namespace smelt {

namespace {

/// A file in memory, so that it can be written whole.
class MemoryStream final : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("memory") {}
  void write(const char c[], int n) override {
    if (at_ + static_cast<std::size_t>(n) > bytes.size()) bytes.resize(at_ + static_cast<std::size_t>(n));
    std::copy(c, c + n, bytes.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ += static_cast<std::size_t>(n);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }

  std::string bytes;

 private:
  std::size_t at_ = 0;
};

/// R, G, B or A, alone or as the last part of a layer's channel.
bool is_colour(std::string_view name) {
  const std::string_view last = name.substr(name.rfind('.') + 1);
  return last == "R" || last == "G" || last == "B" || last == "A";
}

/// Half floats end at 65504: brighter is as bright as they go, as for any camera.
half to_half(float value) {
  return half(std::clamp(value, -65504.0f, 65504.0f));
}

bool is_hdr(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".hdr" || extension == ".pic";
}

}  // namespace

void write_exr(const std::filesystem::path& path, const LayeredImage& image) {
  const std::size_t n = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  std::vector<std::vector<half>> halves;
  halves.reserve(image.channels.size());
  for (const ImageChannel& channel : image.channels) {
    if (channel.values.size() != n || n == 0)
      fail("{}: the channel {} has {} values for {} x {} pixels", path.string(), channel.name, channel.values.size(),
           image.width, image.height);
    const bool short_float = is_colour(channel.name);
    const Imf::PixelType type = short_float ? Imf::HALF : Imf::FLOAT;
    header.channels().insert(channel.name, Imf::Channel(type));
    const std::size_t size = short_float ? sizeof(half) : sizeof(float);
    char* base = const_cast<char*>(reinterpret_cast<const char*>(channel.values.data()));
    if (short_float) {
      auto& values = halves.emplace_back(n);
      std::transform(channel.values.begin(), channel.values.end(), values.begin(), to_half);
      base = reinterpret_cast<char*>(values.data());
    }
    buffer.insert(channel.name, Imf::Slice(type, base, size, size * static_cast<std::size_t>(image.width)));
  }
  MemoryStream stream;
  try {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(image.height);
  } catch (const std::exception& error) {
    fail("{}: cannot encode the image: {}", path.string(), error.what());
  }
  write_file_atomically(path, stream.bytes);
}

LayeredImage read_exr(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) fail("{}: there is no such file", path.string());
  try {
    Imf::InputFile file(path.c_str(), 0);
    const auto window = file.header().dataWindow();
    LayeredImage image{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}};
    const std::size_t n = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    for (auto c = file.header().channels().begin(); c != file.header().channels().end(); ++c)
      image.channels.push_back({c.name(), std::vector<float>(n)});
    Imf::FrameBuffer buffer;
    const std::size_t row = sizeof(float) * static_cast<std::size_t>(image.width);
    for (ImageChannel& channel : image.channels) {
      char* first = reinterpret_cast<char*>(channel.values.data()) -
                    static_cast<std::ptrdiff_t>(window.min.y) * static_cast<std::ptrdiff_t>(row) -
                    static_cast<std::ptrdiff_t>(window.min.x) * static_cast<std::ptrdiff_t>(sizeof(float));
      buffer.insert(channel.name, Imf::Slice(Imf::FLOAT, first, sizeof(float), row));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return image;
  } catch (const std::exception& error) {
    fail("{}: cannot be read as OpenEXR: {}", path.string(), error.what());
  }
}

RadianceImage read_radiance(const std::filesystem::path& path) {
  RadianceImage image;
  if (is_hdr(path)) {
    image = read_radiance_hdr(path);
  } else {
    const LayeredImage layers = read_exr(path);
    image = {layers.width, layers.height,
             std::vector<Vec3f>(static_cast<std::size_t>(layers.width) * static_cast<std::size_t>(layers.height))};
    for (int c = 0; c < 3; ++c) {
      const std::string name(1, "RGB"[c]);
      const auto channel = std::find_if(layers.channels.begin(), layers.channels.end(),
                                        [&](const ImageChannel& k) { return k.name == name; });
      if (channel == layers.channels.end())
        fail("{}: has no channel {}; a panorama needs R, G and B", path.string(), name);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i][c] = channel->values[i];
    }
  }
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (!image.pixels[i].allFinite() || image.pixels[i].minCoeff() < 0.0f)
      fail("{}: pixel ({}, {}) is ({}, {}, {}); light is finite and not negative", path.string(),
           i % static_cast<std::size_t>(image.width), i / static_cast<std::size_t>(image.width), image.pixels[i].x(),
           image.pixels[i].y(), image.pixels[i].z());
  return image;
}

}  // namespace smelt
