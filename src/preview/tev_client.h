/// The preview: shows images in the viewer tev while they are rendered, and never makes the
/// renderer wait for it.
#pragma once

#include <memory>
#include <string>

#include "image/image.h"

namespace covtrace {

/// A connection to the viewer, by a thread of its own that connects, sends, and connects again. A
/// viewer that is absent, comes late, hangs, is slow or goes away costs the caller nothing: images
/// wait in one place that the newest takes.
class TevClient {
  public:
    /// Begins to connect to `host` and `port`, as the system resolves them. `name` is that of the
    /// image in tev.
    TevClient(std::string host, std::string port, std::string name);
    /// Ends the connection at once, as finish(0) does.
    ~TevClient();
    TevClient(const TevClient&) = delete;
    TevClient& operator=(const TevClient&) = delete;

    /// Hands the image over and returns at once.
    void show(Image image);
    /// Waits for the last image to be sent as long as the viewer keeps taking bytes, but at most
    /// `seconds`; nothing is sent afterwards.
    void finish(double seconds);
    /// Takes the reason, in words, why the viewer was not there when it was first looked for or,
    /// after finish(), why it never was. It is told once: empty before it is known, after it was
    /// taken, and where the viewer was there.
    std::string take_failure();

  private:
    struct State;
    std::shared_ptr<State>
        state_;  ///< shared with the thread, which may outlive this in a name look-up
};

}  // namespace covtrace
