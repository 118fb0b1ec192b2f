// What the arena needs of tinybvh, behind a C interface: builds of two layouts, rays in a loop, refits, a top level, bytes.

#include <atomic>
#include <cfloat>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <fstream>
#include <immintrin.h>
#include <malloc.h>
#include <memory>
#include <mutex>
#include <condition_variable>
#include <mm_malloc.h>
#include <new>

namespace {

// All memory of tinybvh goes through _mm_malloc: counted here, at the one place that sees all of it.
std::atomic<int64_t> current_bytes{ 0 };
std::atomic<int64_t> peak_bytes{ 0 };

void* counted_malloc( size_t size, size_t alignment )
{
	void* pointer = _mm_malloc( size, alignment );
	if (!pointer) return pointer;
	const int64_t now = current_bytes.fetch_add( (int64_t)malloc_usable_size( pointer ) ) + (int64_t)malloc_usable_size( pointer );
	int64_t peak = peak_bytes.load();
	while (now > peak && !peak_bytes.compare_exchange_weak( peak, now )) {}
	return pointer;
}

void counted_free( void* pointer )
{
	if (pointer) current_bytes.fetch_sub( (int64_t)malloc_usable_size( pointer ) );
	_mm_free( pointer );
}

}

#define _mm_malloc counted_malloc
#define _mm_free counted_free
#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"

using namespace tinybvh;

namespace {

// As ropewalk has it.
struct InputRay { float origin[3], t_min, dir[3], t_max; uint32_t mask; };

// Where answers go: fields of structures that lie `stride` bytes apart.
struct Output { char* t; char* uv; char* primitive; char* instance; size_t stride; };

template <class T> void put( char* base, size_t stride, size_t index, T value )
{
	if (base) memcpy( base + stride * index, &value, sizeof( T ) );
}

inline void fill( Ray& ray, const InputRay& from )
{
	// By hand: the constructor would normalise the direction again and clear the 56 bytes for the user.
	ray.O = bvhvec3( from.origin[0], from.origin[1], from.origin[2] );
	ray.D = bvhvec3( from.dir[0], from.dir[1], from.dir[2] );
	ray.rD = tinybvh_rcp( ray.D );
	ray.mask = RAY_MASK_INTERSECT_ALL;
	ray.instIdx = 0;
	ray.hit.t = from.t_max < BVH_FAR ? from.t_max : BVH_FAR;
	ray.hit.prim = 0xffffffff;
	ray.hit.inst = 0xffffffff;
}

template <class Structure>
void closest( const Structure& structure, const InputRay* rays, size_t count, const Output& output )
{
	for (size_t i = 0; i < count; i++)
	{
		Ray ray;
		fill( ray, rays[i] );
		const float limit = ray.hit.t;
		structure.Intersect( ray );
		const bool hit = ray.hit.t < limit;
		put( output.t, output.stride, i, hit ? ray.hit.t : INFINITY );
		put( output.primitive, output.stride, i, hit ? ray.hit.prim : 0xffffffffu );
		put( output.instance, output.stride, i, hit ? ray.hit.inst : 0xffffffffu );
		const float uv[2] = { hit ? ray.hit.u : 0, hit ? ray.hit.v : 0 };
		if (output.uv) memcpy( output.uv + output.stride * i, uv, sizeof( uv ) );
	}
}

template <class Structure> void any( const Structure& structure, const InputRay* rays, size_t count, bool* hits )
{
	for (size_t i = 0; i < count; i++)
	{
		Ray ray;
		fill( ray, rays[i] );
		hits[i] = structure.IsOccluded( ray );
	}
}

struct Tree
{
	std::unique_ptr<BVH4_CPU> four;
	std::unique_ptr<BVH8_CPU> eight;
	BVHBase* base() { return four ? (BVHBase*)four.get() : (BVHBase*)eight.get(); }
};

template <class Structure, class Inner>
void build( Structure& structure, Inner& inner, bool quality, bool threaded, const bvhvec4slice& vertices )
{
	inner.threadedBuild = threaded;
	if (quality) structure.BuildHQ( vertices ); else structure.Build( vertices );
}

struct Copies
{
	BVH top;
	std::vector<BLASInstance> instances;
	BVHBase* list[1];
};

}

extern "C" {

int64_t ropewalk_tinybvh_bytes() { return current_bytes.load(); }
int64_t ropewalk_tinybvh_peak() { return peak_bytes.load(); }
void ropewalk_tinybvh_reset_peak() { peak_bytes.store( current_bytes.load() ); }

// `vertices` are three times four floats a triangle and outlive the tree.
void* ropewalk_tinybvh_build( uint32_t width, bool quality, bool threaded, const float* vertices, uint32_t triangles )
{
	if (triangles == 0) return nullptr;
	auto tree = std::make_unique<Tree>();
	const bvhvec4slice slice( (const bvhvec4*)vertices, triangles * 3, sizeof( bvhvec4 ) );
	if (width == 4)
	{
		tree->four = std::make_unique<BVH4_CPU>();
		build( *tree->four, tree->four->bvh4.bvh, quality, threaded, slice );
	}
	else
	{
		tree->eight = std::make_unique<BVH8_CPU>();
		build( *tree->eight, tree->eight->bvh8.bvh, quality, threaded, slice );
	}
	return tree.release();
}

void ropewalk_tinybvh_free( void* tree ) { delete (Tree*)tree; }

// The bytes that rays read.
uint64_t ropewalk_tinybvh_size( void* pointer )
{
	Tree* tree = (Tree*)pointer;
	return 64ull * (tree->four ? tree->four->usedBlocks : tree->eight->usedBlocks);
}

void ropewalk_tinybvh_closest( void* pointer, const void* rays, size_t count, const Output* output )
{
	Tree* tree = (Tree*)pointer;
	if (tree->four) closest( *tree->four, (const InputRay*)rays, count, *output );
	else closest( *tree->eight, (const InputRay*)rays, count, *output );
}

void ropewalk_tinybvh_any( void* pointer, const void* rays, size_t count, bool* hits )
{
	Tree* tree = (Tree*)pointer;
	if (tree->four) any( *tree->four, (const InputRay*)rays, count, hits );
	else any( *tree->eight, (const InputRay*)rays, count, hits );
}

// The vertices that the tree was built of have moved.
void ropewalk_tinybvh_refit( void* pointer )
{
	Tree* tree = (Tree*)pointer;
	if (tree->four) tree->four->Refit(); else tree->eight->Refit();
}

void* ropewalk_tinybvh_copies( void* pointer )
{
	Copies* copies = new Copies();
	copies->list[0] = ((Tree*)pointer)->base();
	return copies;
}

void ropewalk_tinybvh_free_copies( void* copies ) { delete (Copies*)copies; }

// `places` are 16 floats each, row by row.
void ropewalk_tinybvh_place( void* pointer, const float* places, size_t count )
{
	Copies* copies = (Copies*)pointer;
	copies->instances.resize( count );
	for (size_t i = 0; i < count; i++) memcpy( &copies->instances[i].transform, places + 16 * i, 64 );
	copies->top.Build( copies->instances.data(), (uint32_t)count, copies->list, 1 );
}

void ropewalk_tinybvh_among( void* pointer, const void* rays, size_t count, const Output* output )
{
	closest( ((Copies*)pointer)->top, (const InputRay*)rays, count, *output );
}

}
