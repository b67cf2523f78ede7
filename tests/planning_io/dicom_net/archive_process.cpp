#include "tests/planning_io/dicom_net/archive_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>

#include "planning_io/types/error.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr const char* kOrthanc = "/usr/sbin/Orthanc";

sockaddr_in this_computer(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

int listen_somewhere(int& port) {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = this_computer(0);
    socklen_t size = sizeof(address);
    if (::bind(socket, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(socket, 4) != 0 ||
        ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0)
        throw std::runtime_error("no free port");
    port = ntohs(address.sin_port);
    return socket;
}

/// False where nothing is left to be passed on, or not any more.
bool pass_on(int from, int to, std::size_t& left) {
    std::array<char, 4096> bytes{};
    const ssize_t got = ::recv(from, bytes.data(), std::min(bytes.size(), left), 0);
    if (got <= 0) return false;
    left -= static_cast<std::size_t>(got);
    return ::send(to, bytes.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL) == got && left > 0;
}

bool listens(int port) {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in address = this_computer(port);
    const bool connected = ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    ::close(socket);
    return connected;
}

}  // namespace

int free_port() {
    int port = 0;
    ::close(listen_somewhere(port));
    return port;
}

bool answers_soon(const DicomPeer& peer) {
    for (int attempt = 0; attempt < 300; ++attempt) {
        try {
            ask_whether_it_answers(peer);
            return true;
        } catch (const Error&) {  // it is still starting
            std::this_thread::sleep_for(100ms);
        }
    }
    if (listens(peer.port)) throw std::runtime_error("an archive listens, and our C-ECHO has no answer of it");
    return false;
}

RunningProgram::RunningProgram(const std::vector<std::string>& words, const fs::path& log) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    process_ = ::fork();
    if (process_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int out = ::open(log.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    ::dup2(out, 1);
    ::dup2(out, 2);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
}

RunningProgram::~RunningProgram() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

Orthanc::Orthanc(const fs::path& folder, int port, const std::string& settings) : storage_(folder / "storage") {
    peer_.host = "127.0.0.1";
    peer_.port = port;
    peer_.title = "ARCHIVE";
    peer_.patience = std::chrono::seconds(20);
    fs::create_directories(storage_);
    std::ofstream(folder / "orthanc.json") << fmt::format(
        R"({{"Name": "test", "StorageDirectory": "{0}", "IndexDirectory": "{0}", "HttpServerEnabled": false,
"DicomServerEnabled": true, "DicomAet": "ARCHIVE", "DicomCheckCalledAet": true, "DicomPort": {1},
"DicomModalities": {{"planlight": ["PLANLIGHT", "127.0.0.1", 104]}}, "DicomAlwaysAllowEcho": false,
"DicomAlwaysAllowStore": false, "Plugins": [], "MaximumStorageCacheSize": 0, "ConcurrentJobs": 1{2}}})",
        storage_.string(), port, settings);
    program_ = std::make_unique<RunningProgram>(std::vector<std::string>{kOrthanc, (folder / "orthanc.json").string()},
                                                folder / "orthanc.log");
}

std::unique_ptr<Orthanc> Orthanc::start(const fs::path& folder, const std::string& settings, const DicomTls& tls) {
    if (!fs::exists(kOrthanc)) return nullptr;
    std::unique_ptr<Orthanc> archive(new Orthanc(folder, free_port(), settings));
    archive->peer_.tls = tls;
    if (!answers_soon(archive->peer())) return nullptr;
    return archive;
}

std::unique_ptr<Dcmqrscp> Dcmqrscp::start(const fs::path& folder, bool sends_only, int own_port) {
    const fs::path program = "/usr/bin/dcmqrscp";
    if (!fs::exists(program)) return nullptr;
    auto archive = std::make_unique<Dcmqrscp>();
    archive->storage_ = folder / "kept";
    fs::create_directories(archive->storage_);
    DicomPeer& peer = archive->peer_;
    peer.host = "127.0.0.1";
    peer.port = free_port();
    peer.title = "ARCHIVE";
    peer.patience = std::chrono::seconds(10);
    std::ofstream(folder / "dcmqrscp.cfg")
        << "NetworkTCPPort = " << peer.port << "\nMaxPDUSize = 16384\nMaxAssociations = 16\nHostTable BEGIN\n"
        << (own_port > 0 ? fmt::format("planlight = (PLANLIGHT, 127.0.0.1, {})\n", own_port) : "")
        << "HostTable END\nVendorTable BEGIN\nVendorTable END\nAETable BEGIN\nARCHIVE " << archive->storage_.string()
        << " RW (200, 1024mb) ANY\nAETable END\n";
    std::vector<std::string> words{program.string(), "-c", (folder / "dcmqrscp.cfg").string()};
    if (sends_only) words.push_back("--disable-get");
    archive->program_ = std::make_unique<RunningProgram>(words, folder / "dcmqrscp.log");
    return answers_soon(peer) ? std::move(archive) : nullptr;
}

Certificate make_certificate(const fs::path& folder, const std::string& name, Flaw flaw) {
    const Certificate made{folder / (name + ".pem"), folder / (name + ".key")};
    const fs::path request = folder / (name + ".csr"), extension = folder / (name + ".ext");
    std::ofstream(extension) << "subjectAltName="
                             << (flaw == Flaw::of_another_computer ? "DNS:another.example" : "IP:127.0.0.1") << "\n";
    const std::string line = fmt::format(
        "(openssl req -newkey rsa:2048 -nodes -subj /CN={} -keyout '{}' -out '{}' && openssl x509 -req -in '{}' "
        "-signkey '{}' -days {} -extfile '{}' -out '{}') >/dev/null 2>&1",
        name, made.key.string(), request.string(), request.string(), made.key.string(),
        flaw == Flaw::has_run_out ? -1 : 2, extension.string(), made.certificate.string());
    return std::system(line.c_str()) == 0 ? made : Certificate{};
}

FullDisk::FullDisk(std::size_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);  // else the process is ended
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit full{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
}

FullDisk::~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
}

CutLine::CutLine(int to_port, std::size_t bytes_from_there, std::size_t bytes_to_there)
    : listener_(listen_somewhere(port_)), thread_([=, this] { run(to_port, bytes_from_there, bytes_to_there); }) {}

CutLine::~CutLine() {
    ending_ = true;
    thread_.join();
    ::close(listener_);
}

void CutLine::run(int to_port, std::size_t from_there, std::size_t to_there) const {
    while (!ending_) {
        pollfd waiting{listener_, POLLIN, 0};
        if (::poll(&waiting, 1, 20) <= 0) continue;
        const int here = ::accept(listener_, nullptr, nullptr),
                  there = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const sockaddr_in address = this_computer(to_port);
        if (::connect(there, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
            std::size_t from_left = from_there, to_left = to_there;
            for (bool open = true; open && !ending_;) {
                std::array<pollfd, 2> lines{pollfd{here, POLLIN, 0}, pollfd{there, POLLIN, 0}};
                if (::poll(lines.data(), lines.size(), 20) <= 0) continue;
                if (lines[0].revents) open = pass_on(here, there, to_left);
                if (open && lines[1].revents) open = pass_on(there, here, from_left);
            }
        }
        ::close(here);
        ::close(there);
    }
}

}  // namespace planlight::test
