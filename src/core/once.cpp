#include "core/once.h"

#include <oneapi/tbb/collaborative_call_once.h>

namespace covtrace {

struct Once::Impl {
    oneapi::tbb::collaborative_once_flag flag;
};

Once::Once() : impl_(std::make_unique<Impl>()) {}
Once::~Once() = default;

void Once::call(const std::function<void()>& work) const {
    oneapi::tbb::collaborative_call_once(impl_->flag, [&work] { work(); });
    done_.store(true, std::memory_order_release);
}

}  // namespace covtrace
