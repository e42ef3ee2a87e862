#include "preview/tev_client.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "preview/tev_messages.h"

namespace covtrace {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// Time until a request to stop is seen; a viewer that takes no byte for so long is stalled.
constexpr milliseconds kPoll{50};
constexpr milliseconds kConnectTimeout{2000};
constexpr milliseconds kRetry{500};  // time between attempts to connect
constexpr const char* kNoAnswer = "no answer yet";
constexpr size_t kMessageBytes = 1 << 20;  // rough size of a message: rows are sent in bands

}  // namespace

struct TevClient::State {
    const std::string host, port, name;

    std::mutex mutex;
    std::condition_variable changed;
    std::optional<Image> waiting;               ///< the newest image that is not being sent
    std::optional<Clock::time_point> deadline;  ///< set by finish()
    bool ended = false;                         ///< whether the thread has ended
    bool connected = false;                     ///< whether the viewer was ever connected
    /// Failure of the first attempt; empty text once it is told.
    std::optional<std::string> failure;

    // The following members belong to the thread alone.
    int socket = -1;
    std::vector<std::string> created;  ///< channels of the image that the viewer has
    std::pair<int, int> created_size;  ///< width and height of that image
    bool had_focus = false;            ///< whether an image took tev's focus: only the first does

    State(std::string h, std::string p, std::string n)
        : host(std::move(h)), port(std::move(p)), name(std::move(n)) {}
    ~State() { disconnect(); }

    void run();
    /// Sends an image; false where the viewer is gone, or finish() gives no more time.
    bool send_image(const Image& image);
    bool send_all(const std::string& bytes);
    /// Connects to the viewer; false where no address of the host answers.
    bool connect();
    /// Connects to one address. Returns the reason why it cannot be done, empty where it is.
    std::string connect_to(const addrinfo& address);
    /// Keeps the reason of the first failure, unless the viewer was there before.
    void keep_failure(const std::string& why) {
        const std::lock_guard lock(mutex);
        if (!failure && !connected) failure = why;
    }
    void disconnect();
    bool peer_is_gone() const;
    /// Whether finish() gives no more time; `stalled`: the viewer has not moved for a while.
    bool out_of_time(bool stalled) {
        const std::lock_guard lock(mutex);
        return deadline && (stalled || Clock::now() >= *deadline);
    }
};

void TevClient::State::run() {
    std::optional<Image> current;
    while (true) {
        {
            std::unique_lock lock(mutex);
            changed.wait(lock, [&] { return waiting || deadline || current; });
            if (waiting) current = std::exchange(waiting, std::nullopt);
            if (!current) break;  // asked to end, and everything is sent
        }
        if (out_of_time(false)) break;
        if (socket >= 0 && peer_is_gone()) disconnect();
        if ((socket >= 0 || connect()) && send_image(*current)) {
            current.reset();
            continue;
        }
        disconnect();
        std::unique_lock lock(mutex);
        if (deadline) break;
        changed.wait_for(lock, kRetry, [&] { return deadline.has_value(); });
    }
    disconnect();
    const std::lock_guard lock(mutex);
    ended = true;
    changed.notify_all();
}

bool TevClient::State::send_image(const Image& image) {
    std::vector<std::string> channels;
    for (const Channel& c : image.channels) channels.push_back(c.name);
    const std::pair size(image.display.width(), image.display.height());
    if (created != channels || created_size != size) {
        if (!send_all(tev_create_image(name, !had_focus, size.first, size.second, channels)))
            return false;
        created = channels;
        created_size = size;
        had_focus = true;
    }
    const size_t row_bytes = size_t(image.width()) * channels.size() * sizeof(float);
    const int rows = int(std::max<size_t>(1, kMessageBytes / row_bytes));
    for (int y = image.data.y0; y < image.data.y1; y += rows)
        if (!send_all(tev_update_image(name, image, y, std::min(y + rows, image.data.y1))))
            return false;
    return true;
}

bool TevClient::State::send_all(const std::string& bytes) {
    size_t sent = 0;
    while (sent < bytes.size()) {
        pollfd waiting_for{socket, POLLOUT, 0};
        const int ready = ::poll(&waiting_for, 1, int(kPoll.count()));
        if (out_of_time(ready == 0)) return false;
        if (ready <= 0) continue;
        const ssize_t n =
            ::send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n < 0 && errno != EAGAIN && errno != EINTR) return false;
        if (n > 0) sent += size_t(n);
    }
    return true;
}

bool TevClient::State::connect() {
    addrinfo hints{};
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found)) {
        keep_failure(::gai_strerror(error));
        return false;
    }
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
    std::string why;
    for (const addrinfo* a = found; a; a = a->ai_next) {
        why = connect_to(*a);
        if (!why.empty()) continue;
        const std::lock_guard lock(mutex);
        connected = true;
        return true;
    }
    keep_failure(why);
    return false;
}

std::string TevClient::State::connect_to(const addrinfo& address) {
    disconnect();
    socket = ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK,
                      address.ai_protocol);
    const auto reason = [](int error) { return std::generic_category().message(error); };
    if (socket < 0) return reason(errno);
    if (::connect(socket, address.ai_addr, address.ai_addrlen) == 0) return {};
    if (errno != EINPROGRESS) return reason(errno);
    const auto give_up = Clock::now() + kConnectTimeout;
    while (Clock::now() < give_up) {
        pollfd waiting_for{socket, POLLOUT, 0};
        const int ready = ::poll(&waiting_for, 1, int(kPoll.count()));
        if (ready > 0) {
            int error = 0;
            socklen_t size = sizeof error;
            if (::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
            return error == 0 ? std::string() : reason(error);
        }
        if (out_of_time(true)) break;
    }
    return kNoAnswer;
}

void TevClient::State::disconnect() {
    if (socket >= 0) ::close(socket);
    socket = -1;
    created.clear();
}

bool TevClient::State::peer_is_gone() const {
    char byte;
    const ssize_t n = ::recv(socket, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR);
}

TevClient::TevClient(std::string host, std::string port, std::string name)
    : state_(std::make_shared<State>(std::move(host), std::move(port), std::move(name))) {
    // The thread is detached, since a look-up of the host's name can neither be ended nor waited
    // for; finish() waits for everything else.
    std::thread([state = state_] { state->run(); }).detach();
}

TevClient::~TevClient() {
    finish(0);
}

void TevClient::show(Image image) {
    const std::lock_guard lock(state_->mutex);
    if (state_->deadline) return;
    state_->waiting = std::move(image);
    state_->changed.notify_all();
}

void TevClient::finish(double seconds) {
    std::unique_lock lock(state_->mutex);
    if (!state_->deadline)
        state_->deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(seconds));
    state_->changed.notify_all();
    state_->changed.wait_until(lock, *state_->deadline + 2 * kPoll, [&] { return state_->ended; });
}

std::string TevClient::take_failure() {
    const std::lock_guard lock(state_->mutex);
    // A look-up of the name may still be under way: there is no answer yet.
    if (state_->deadline && !state_->connected && !state_->failure) state_->failure = kNoAnswer;
    return state_->failure ? std::exchange(*state_->failure, {}) : std::string();
}

}  // namespace covtrace
