// Traversal lists in two buffers of their own.
// Source: as shared/list.
// Invariants: the same names as level_list.

@group(#{STRUCTURE_GROUP}) @binding(0) var<storage, read> list_words: array<u32>;
@group(#{STRUCTURE_GROUP}) @binding(1) var<storage, read> list_shared: array<u32>;

fn list_word(place: u32) -> u32 {
    return list_words[place];
}

fn shared_word(place: u32) -> u32 {
    return list_shared[place];
}
