#include "planning_io/dicom/inflated_dicom.h"

#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <cstdint>
#include <fstream>
#include <vector>

#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

const std::string kDeflated = "1.2.840.10008.1.2.1.99";
const std::string kExplicit = std::string("1.2.840.10008.1.2.1\0\0\0", 22);
constexpr std::size_t kMostBytes = std::size_t{1} << 30;

/// Where the file's first group ends, from its length element; 0 when there is none.
std::size_t end_of_first_group(const std::string& head) {
    if (head.size() < 144 || head.compare(128, 4, "DICM") != 0 ||
        head.compare(132, 8, std::string("\2\0\0\0UL\4\0", 8)) != 0)
        return 0;
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i)
        length |= static_cast<std::uint32_t>(static_cast<unsigned char>(head[140 + i])) << (8 * i);
    return 144 + std::size_t{length};
}

std::string inflate_all(const std::string& packed, std::size_t from, const fs::path& file) {
    z_stream z{};
    inflateInit2(&z, -15);  // without a header, as DICOM PS3.5 A.5 has it
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + from));
    z.avail_in = static_cast<uInt>(packed.size() - from);
    std::string all;
    std::vector<char> block(1 << 18);
    int code = Z_OK;
    while (code == Z_OK && all.size() < kMostBytes) {
        z.next_out = reinterpret_cast<Bytef*>(block.data());
        z.avail_out = static_cast<uInt>(block.size());
        code = inflate(&z, Z_NO_FLUSH);
        all.append(block.data(), block.size() - z.avail_out);
        if (z.avail_in == 0 && z.avail_out != 0 && code != Z_STREAM_END) break;
    }
    inflateEnd(&z);
    if (code != Z_STREAM_END) throw DamagedFileError(file, "cannot be inflated", "Copy or export the series again.");
    return all;
}

}  // namespace

std::string inflated_dicom(const fs::path& file) {
    std::string head(2048, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(in.gcount()));
    const std::size_t end = end_of_first_group(head);
    const std::size_t uid = head.find(kDeflated);
    if (end == 0 || uid == std::string::npos || uid > end) return file.string();
    const std::string whole = read_whole(file);
    if (whole.size() < end || whole.size() > kMostBytes)
        throw DamagedFileError(file, "is cut short", "Copy or export the series again.");
    std::string inflated =
        whole.substr(0, end).replace(uid, kDeflated.size(), kExplicit) + inflate_all(whole, end, file);
    const int memory = memfd_create("planlight-dicom", 0);
    for (std::size_t done = 0; memory >= 0 && done < inflated.size();) {
        const ssize_t wrote = write(memory, inflated.data() + done, inflated.size() - done);
        if (wrote <= 0) throw DiskError(file, "there is no room to inflate it", "Close other programs and try again.");
        done += static_cast<std::size_t>(wrote);
    }
    if (memory < 0) throw DiskError(file, "there is no room to inflate it", "Close other programs and try again.");
    return "/proc/self/fd/" + std::to_string(memory);
}

}  // namespace planlight
