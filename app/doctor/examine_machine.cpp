#include "app/doctor/examine_machine.h"

#include <algorithm>
#include <fstream>

#include "planning_io/types/error.h"
#include "projection/monitor/opengl_driver.h"
#include "projection/monitor/realtime_priority.h"

namespace planlight {
namespace fs = std::filesystem;

std::optional<std::size_t> receive_buffer_max() {
    std::ifstream file("/proc/sys/net/core/rmem_max");
    std::size_t bytes = 0;
    return file >> bytes ? std::optional(bytes) : std::nullopt;
}

MachineFigures examine_machine(const fs::path& folder) {
    MachineFigures machine;
    std::error_code failure;
    const fs::path there = fs::absolute(folder, failure);
    machine.folder = there.string();
    if (const fs::space_info space = fs::space(there, failure); !failure) machine.free_bytes = space.available;
    try {
        machine.gl_renderer = opengl_driver();
    } catch (const Error& error) {
        machine.gl_problem = error.what();
        machine.gl_remedy = error.remedy;
    }
    machine.dark_after = monitors_dark_after();
    machine.realtime_priority = may_have_realtime_priority();
    for (const auto& cpu : fs::directory_iterator("/sys/devices/system/cpu", failure)) {
        std::ifstream file(cpu.path() / "cpufreq" / "scaling_governor");
        std::string governor;
        if (file >> governor &&
            std::find(machine.governors.begin(), machine.governors.end(), governor) == machine.governors.end())
            machine.governors.push_back(governor);
    }
    return machine;
}

}  // namespace planlight
