#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planning_io/dicom_net/dicom_peer.h"

namespace planlight::test {

/// A port of this computer that nobody listens on.
int free_port();

/// Whether it answers within half a minute: a program takes a while to start. Throws where it listens and still does
/// not answer: that would be ours.
bool answers_soon(const DicomPeer& peer);

/// A program that runs until the object ends.
class RunningProgram {
public:
    RunningProgram(const std::vector<std::string>& words, const std::filesystem::path& log);
    ~RunningProgram();
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

private:
    pid_t process_ = -1;
};

/// Debian's orthanc on a free port of this computer, empty, with a folder of its own. It is called ARCHIVE, knows
/// PLANLIGHT alone and answers nobody else.
class Orthanc {
public:
    /// Empty where the package orthanc is not installed, or it does not answer in half a minute.
    /// `settings`: further entries of its configuration (JSON, each with a comma before it). `tls`: how it is asked.
    static std::unique_ptr<Orthanc> start(const std::filesystem::path& folder, const std::string& settings = {},
                                          const DicomTls& tls = {});
    const DicomPeer& peer() const { return peer_; }
    /// Where it keeps the objects, a file each.
    std::filesystem::path storage() const { return storage_; }

private:
    Orthanc(const std::filesystem::path& folder, int port, const std::string& settings);
    DicomPeer peer_;
    std::filesystem::path storage_;
    std::unique_ptr<RunningProgram> program_;
};

/// DCMTK's dcmqrscp on a free port of this computer, called ARCHIVE; it lists by its index, and gives what there are
/// files of. It lets nothing be fetched (C-GET) where `sends_only`, and sends (C-MOVE) to PLANLIGHT at `own_port` of
/// this computer; 0: it knows nobody.
class Dcmqrscp {
public:
    /// Empty where the package dcmtk is not installed, or it does not answer in half a minute.
    static std::unique_ptr<Dcmqrscp> start(const std::filesystem::path& folder, bool sends_only, int own_port);
    const DicomPeer& peer() const { return peer_; }
    const std::filesystem::path& storage() const { return storage_; }

private:
    DicomPeer peer_;
    std::filesystem::path storage_;
    std::unique_ptr<RunningProgram> program_;
};

/// A certificate with its key, as files.
struct Certificate {
    std::filesystem::path certificate, key;
};
enum class Flaw { none, of_another_computer, has_run_out };
/// One that signs itself, made out to `name` for 127.0.0.1; by the program openssl. Empty files where that is not
/// installed.
Certificate make_certificate(const std::filesystem::path& folder, const std::string& name, Flaw flaw = Flaw::none);

/// While it lives, no file that this process writes grows beyond so many bytes: the disk is full.
class FullDisk {
public:
    explicit FullDisk(std::size_t bytes);
    ~FullDisk();

private:
    rlimit before_{};
};

/// A line to another port of this computer that is cut after so many bytes from there, or to there.
class CutLine {
public:
    CutLine(int to_port, std::size_t bytes_from_there, std::size_t bytes_to_there);
    ~CutLine();
    int port() const { return port_; }

private:
    void run(int to_port, std::size_t from_there, std::size_t to_there) const;
    int port_ = 0;
    int listener_ = -1;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace planlight::test
