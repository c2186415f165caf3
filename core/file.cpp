#include "core/file.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/error.h"

namespace sheaf {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& path, std::string_view reason) {
  throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", path.string(), reason));
}

using FilePtr = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

FilePtr openToRead(const fs::path& path) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) fail(path, "is a directory");
  FilePtr file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) fail(path, fmt::format("cannot be opened: {}", std::strerror(errno)));
  return file;
}

std::string readAll(const fs::path& path, std::size_t max_bytes) {
  const FilePtr file = openToRead(path);
  std::string bytes;
  std::error_code ec;
  const auto size_hint = fs::file_size(path, ec);
  if (!ec && size_hint > max_bytes) fail(path, fmt::format("is larger than {} bytes", max_bytes));
  // A pipe or a /proc file has no size: read on until the end in any case.
  bytes.resize(ec ? 0 : size_hint);
  std::size_t used = std::fread(bytes.data(), 1, bytes.size(), file.get());
  bytes.resize(used);
  for (char block[65536]; const std::size_t n = std::fread(block, 1, sizeof block, file.get());) {
    if (bytes.size() + n > max_bytes) fail(path, fmt::format("is larger than {} bytes", max_bytes));
    bytes.append(block, n);
  }
  if (std::ferror(file.get()) != 0) fail(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  return bytes;
}

bool isGzip(std::string_view bytes) {
  return bytes.size() >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
}

std::string gunzip(const fs::path& path, const std::string& packed, std::size_t max_bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) fail(path, "gzip: out of memory");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, &inflateEnd);
  std::string out;
  std::string block(std::size_t{1} << 20, '\0');
  std::size_t given = 0;
  for (int status = Z_OK;;) {
    if (stream.avail_in == 0 && given < packed.size()) {
      const std::size_t n = std::min<std::size_t>(packed.size() - given, std::size_t{1} << 30);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + given));
      stream.avail_in = static_cast<uInt>(n);
      given += n;
    }
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    status = inflate(&stream, Z_NO_FLUSH);
    const std::size_t made = block.size() - stream.avail_out;
    if (out.size() + made > max_bytes) fail(path, fmt::format("unpacks to more than {} bytes", max_bytes));
    out.append(block, 0, made);
    if (status == Z_STREAM_END) {
      // A gzip file may have several members, one after another.
      if (stream.avail_in == 0 && given == packed.size()) return out;
      if (inflateReset(&stream) != Z_OK) fail(path, "damaged gzip data");
    } else if (status == Z_BUF_ERROR ||
               (status == Z_OK && made == 0 && stream.avail_in == 0 && given == packed.size())) {
      fail(path, fmt::format("truncated gzip data after {} unpacked bytes", out.size()));
    } else if (status != Z_OK) {
      fail(path, fmt::format("damaged gzip data after {} unpacked bytes", out.size()));
    }
  }
}

}  // namespace

std::string readFile(const fs::path& path, bool unpack, std::size_t max_bytes) {
  std::string bytes = readAll(path, max_bytes);
  return unpack && isGzip(bytes) ? gunzip(path, bytes, max_bytes) : bytes;
}

void replaceFile(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) fail(path, "is a directory");
  // /dev/null, /dev/stdout and pipes are written in place: renaming would replace the device by a file.
  if (fs::exists(path, ec) && !fs::is_regular_file(path, ec)) return write(path);
  fs::path temporary = path;
  temporary.replace_filename(fmt::format(".{}.{}{}", path.stem().string(), getpid(), path.extension().string()));
  try {
    write(temporary);
    fs::rename(temporary, path, ec);
    if (ec) fail(path, fmt::format("cannot be written: {}", ec.message()));
  } catch (...) {
    fs::remove(temporary, ec);
    throw;
  }
}

void writeFile(const fs::path& path, std::string_view bytes) {
  replaceFile(path, [&](const fs::path& temporary) {
    FilePtr file(std::fopen(temporary.c_str(), "wb"), &std::fclose);
    if (!file) fail(path, fmt::format("cannot be written: {}", std::strerror(errno)));
    const bool written = bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
    if (std::fclose(file.release()) != 0 || !written)
      fail(path, fmt::format("cannot be written: {}", std::strerror(errno)));
  });
}

}  // namespace sheaf
