#pragma once

#include <memory>
#include <string>

#include "planning_io/types/time.h"

namespace planlight {

/// Looks, with a thread of its own, whether a monitor is black when it should be, as the X server has it: a compositor
/// that hangs keeps the last picture there, whatever its window shows meanwhile, and a desktop may draw over all
/// windows. Lit is a monitor with 20 pixels or more of an eighth of full light in any colour, in two looks one after
/// the other. It is made black by the output's gamma (`BlackGamma`) until the picture beneath is black again.
///
/// Where the X server gives no picture, or the monitor is not the projector's alone (`projector_output`), nothing is
/// known: nothing is done then, and nothing undone. Moments are of the wall's monotonic clock. May be used from any
/// thread.
class DarkWatch {
public:
    enum class State {
        as_it_should,
        blackened,  ///< it was lit, and its gamma is black: dark where the output obeys that
        lit         ///< and its gamma does not stay black
    };

    /// A monitor that was left black by its gamma is blackened at first.
    explicit DarkWatch(std::string monitor);
    /// To be dark from now on at the latest; waits until it has looked, a quarter of a second say, a second at most.
    /// What is still lit then stays black, until the next one finds it dark.
    ~DarkWatch();
    DarkWatch(const DarkWatch&) = delete;
    DarkWatch& operator=(const DarkWatch&) = delete;

    /// The light is to be out from then on: the expiry of a picture, to be told before it is lit, or now.
    void expect_dark_from(Instant moment);
    /// Not after that moment, if it was to be later.
    void expect_dark_by(Instant moment);
    State state() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
