#pragma once

#include <array>
#include <memory>
#include <string>

#include <sys/types.h>

namespace planlight::test {

/// Who listens to a session, good and bad.
enum class Listening { nobody, one, eight, slow, dead, hostile };
inline constexpr std::array kListenings{Listening::nobody, Listening::one,  Listening::eight,
                                        Listening::slow,   Listening::dead, Listening::hostile};
std::string words_of(Listening who);

/// Other systems, in a process of their own that gives way to all else, as they would be on computers of their own. A
/// slow one takes 20 kB a second, a dead one connects and takes nothing, hostile ones send garbage as fast as it is
/// taken, come and go without a pause, and close half of the line; whoever is closed comes again.
class OtherSystems {
public:
    /// Forks: before this program has a second thread.
    OtherSystems();
    ~OtherSystems();
    OtherSystems(const OtherSystems&) = delete;
    OtherSystems& operator=(const OtherSystems&) = delete;

    /// From now on these listen to that port of this computer, and all others are gone.
    void listen(Listening who, int port) const;

private:
    int orders_ = -1;
    pid_t process_ = -1;
};

}  // namespace planlight::test
