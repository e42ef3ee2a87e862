// The module that the program loads where mpirun started it: ranks by MPI.
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>

#include <cstring>
#include <string>

#include "render/film_arrays.h"
#include "render/ranks.h"
#include "render/shard.h"

namespace covtrace {

namespace {

class MpiRanks : public Ranks {
  public:
    MpiRanks() {
        // One thread alone, the one that renders, calls MPI, while others trace.
        int provided = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
        MPI_Comm_rank(MPI_COMM_WORLD, &index_);
        MPI_Comm_size(MPI_COMM_WORLD, &count_);
    }
    ~MpiRanks() override { MPI_Finalize(); }
    MpiRanks(const MpiRanks&) = delete;
    MpiRanks& operator=(const MpiRanks&) = delete;

    int index() const override { return index_; }
    int count() const override { return count_; }

    double of_first(double value) const override {
        MPI_Bcast(&value, 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
        return value;
    }
    bool any(bool value) const override {
        int flag = value;
        MPI_Allreduce(MPI_IN_PLACE, &flag, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
        return flag != 0;
    }
    uint64_t sum(uint64_t value) const override {
        MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
        return value;
    }

    void abort(int code) const override { MPI_Abort(MPI_COMM_WORLD, code); }

    void share_pixels(RenderState& state) const override {
        const std::vector<std::vector<size_t>> pixels = pixels_by_owner(state.region);
        std::vector<int> counts, offsets;
        int total = 0;
        for (const auto& own : pixels) {
            counts.push_back(int(own.size()));
            offsets.push_back(total);
            total += int(own.size());
        }
        for (const FilmArray& array : film_arrays(state))
            share(array, pixels, counts, offsets, size_t(total));
    }

  private:
    std::vector<std::vector<size_t>> pixels_by_owner(const PixelBounds& region) const {
        std::vector<std::vector<size_t>> pixels(static_cast<size_t>(count_));
        const Tiles tiles(region);
        for (int64_t tile = 0; tile < tiles.count(); ++tile) {
            const PixelBounds b = tiles.bounds(tile);
            auto& own = pixels[size_t(tiles.owner(tile, count_))];
            for (int y = b.y0; y < b.y1; ++y)
                for (int x = b.x0; x < b.x1; ++x)
                    own.push_back(size_t(y - region.y0) * size_t(region.width()) +
                                  size_t(x - region.x0));
        }
        return pixels;
    }

    /// Shares an array: gathers the records of all owners one after the other, and puts them back
    /// into it.
    void share(const FilmArray& array, const std::vector<std::vector<size_t>>& pixels,
               const std::vector<int>& counts, const std::vector<int>& offsets,
               size_t total) const {
        const size_t size = array.record_size;
        char* records = static_cast<char*>(array.records);
        std::string packed(total * size, '\0');
        char* out = packed.data() + size_t(offsets[size_t(index_)]) * size;
        for (size_t i : pixels[size_t(index_)]) {
            std::memcpy(out, records + i * size, size);
            out += size;
        }
        MPI_Datatype record;
        MPI_Type_contiguous(int(size), MPI_BYTE, &record);
        MPI_Type_commit(&record);
        MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, packed.data(), counts.data(),
                       offsets.data(), record, MPI_COMM_WORLD);
        MPI_Type_free(&record);
        const char* in = packed.data();
        for (const auto& own : pixels)
            for (size_t i : own) {
                std::memcpy(records + i * size, in, size);
                in += size;
            }
    }

    int index_ = 0, count_ = 1;
};

}  // namespace

}  // namespace covtrace

/// Joins the other processes. The caller owns the result.
extern "C" covtrace::Ranks* covtrace_join_ranks() {
    return new covtrace::MpiRanks;
}
