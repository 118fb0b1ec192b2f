//! Accessors: typed elements in the bytes of a buffer, read with every bound checked when one is opened.
//!
//! Opening costs no memory but for the list of a sparse accessor's exceptions, which is no longer than the bytes
//! that hold them; elements are decoded one by one when asked for. So a document that claims a billion elements
//! is refused, or claims zeros, which cost nothing until a triangle uses them.

use super::buffers::{Buffers, View};
use super::document::get;
use crate::LoadError;

/// The types that components may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    const fn of(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The component that begins at a byte.
    fn read(self, bytes: &[u8], at: usize, normalized: bool) -> f32 {
        let whole = |value: f32, largest: f32| {
            if normalized { (value / largest).max(-1.0) } else { value }
        };
        match self {
            Self::I8 => whole(f32::from(i8::from_le_bytes(chunk(bytes, at))), 127.0),
            Self::U8 => whole(f32::from(u8::from_le_bytes(chunk(bytes, at))), 255.0),
            Self::I16 => whole(f32::from(i16::from_le_bytes(chunk(bytes, at))), 32767.0),
            Self::U16 => whole(f32::from(u16::from_le_bytes(chunk(bytes, at))), 65535.0),
            Self::U32 => whole(u32::from_le_bytes(chunk(bytes, at)) as f32, u32::MAX as f32),
            Self::F32 => f32::from_le_bytes(chunk(bytes, at)),
        }
    }

    /// The unsigned whole number that begins at a byte; 0 for the other types, which no caller opens as indices.
    fn read_index(self, bytes: &[u8], at: usize) -> u32 {
        match self {
            Self::U8 => u32::from(u8::from_le_bytes(chunk(bytes, at))),
            Self::U16 => u32::from(u16::from_le_bytes(chunk(bytes, at))),
            Self::U32 => u32::from_le_bytes(chunk(bytes, at)),
            Self::I8 | Self::I16 | Self::F32 => 0,
        }
    }

    const fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

/// The bytes at a place; zeros beyond the end, where no opened accessor reads.
fn chunk<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    bytes.get(at..).and_then(|rest| rest.first_chunk()).copied().unwrap_or([0; N])
}

/// Elements at equal distances. All of them lie within the bytes.
#[derive(Clone, Copy, Debug)]
struct Elements<'b> {
    bytes: &'b [u8],
    stride: usize,
}

impl<'b> Elements<'b> {
    fn new(view: View<'b>, count: usize, size: usize) -> Result<Self, String> {
        let stride = match usize::try_from(view.stride) {
            Ok(0) => size,
            Ok(stride) if stride >= size => stride,
            _ => {
                return Err(format!("its elements take {size} bytes, but stand {} bytes apart", view.stride));
            }
        };
        let need = match count.checked_sub(1) {
            None => Some(0),
            Some(last) => last.checked_mul(stride).and_then(|start| start.checked_add(size)),
        };
        match need {
            Some(need) if need <= view.bytes.len() => Ok(Self { bytes: view.bytes, stride }),
            _ => Err(format!(
                "{count} elements of {size} bytes, {stride} bytes apart, do not fit the {} bytes that are there",
                view.bytes.len()
            )),
        }
    }

    const fn start(&self, index: usize) -> usize {
        index * self.stride
    }
}

/// An accessor whose elements have `WIDTH` components.
#[derive(Debug)]
pub(super) struct Accessor<'b, const WIDTH: usize> {
    count: usize,
    component: Component,
    normalized: bool,
    /// `None` where all elements are zero.
    elements: Option<Elements<'b>>,
    /// The exceptions of a sparse accessor.
    exceptions: Option<Exceptions<'b>>,
}

#[derive(Debug)]
struct Exceptions<'b> {
    /// Which element is replaced by which value, sorted by element; of several for one element the last one counts.
    places: Vec<(u32, u32)>,
    values: Elements<'b>,
}

impl<'b, const WIDTH: usize> Accessor<'b, WIDTH> {
    /// Opens an accessor; all its elements are there.
    pub(super) fn open(buffers: &'b Buffers<'_>, index: u64) -> Result<Self, LoadError> {
        let malformed = |what: String| buffers.source.malformed(format!("accessors[{index}]"), what);
        let accessor = get(&buffers.document.accessors, index);
        let accessor = accessor.ok_or_else(|| malformed("there is no such accessor".into()))?;
        let wanted = match WIDTH {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        if accessor.kind != wanted {
            return Err(malformed(format!("its type is '{}', here it must be {wanted}", accessor.kind)));
        }
        let unknown = |code: u64| malformed(format!("there is no componentType {code}"));
        let code = accessor.component_type;
        let component = Component::of(code).ok_or_else(|| unknown(code))?;
        let count = match u32::try_from(accessor.count) {
            Ok(count) => count as usize,
            Err(_) => {
                return Err(malformed(format!(
                    "its count is {}; at most {} are read",
                    accessor.count,
                    u32::MAX
                )));
            }
        };
        let size = WIDTH * component.size();
        let elements = match accessor.buffer_view {
            None => None,
            Some(view) => {
                let view = buffers.view(view, accessor.byte_offset)?;
                Some(Elements::new(view, count, size).map_err(malformed)?)
            }
        };
        let exceptions = match &accessor.sparse {
            None => None,
            Some(sparse) => {
                let code = sparse.indices.component_type;
                let kind = Component::of(code).filter(|kind| kind.is_index()).ok_or_else(|| unknown(code))?;
                let indices = buffers.view(sparse.indices.buffer_view, sparse.indices.byte_offset)?;
                let values = buffers.view(sparse.values.buffer_view, sparse.values.byte_offset)?;
                Some(Exceptions::new(sparse.count, count, kind, indices, values, size).map_err(malformed)?)
            }
        };
        Ok(Self { count, component, normalized: accessor.normalized, elements, exceptions })
    }

    /// The number of elements.
    pub(super) const fn count(&self) -> usize {
        self.count
    }

    /// An element; zeros for one that is not there.
    pub(super) fn vector(&self, index: usize) -> [f32; WIDTH] {
        let Some((bytes, start)) = self.locate(index) else {
            return [0.0; WIDTH];
        };
        let size = self.component.size();
        std::array::from_fn(|part| self.component.read(bytes, start + part * size, self.normalized))
    }

    fn locate(&self, index: usize) -> Option<(&'b [u8], usize)> {
        if index >= self.count {
            return None;
        }
        if let Some(exceptions) = &self.exceptions
            && let Some(row) = exceptions.find(index)
        {
            return Some((exceptions.values.bytes, exceptions.values.start(row)));
        }
        self.elements.map(|elements| (elements.bytes, elements.start(index)))
    }
}

impl Accessor<'_, 1> {
    /// The value that is no index but asks to begin anew: the largest of its type. `None` for types that are no indices.
    pub(super) const fn restart(&self) -> Option<u32> {
        match self.component {
            Component::U8 => Some(0xff),
            Component::U16 => Some(0xffff),
            Component::U32 => Some(u32::MAX),
            Component::I8 | Component::I16 | Component::F32 => None,
        }
    }

    /// An element of an accessor of indices.
    pub(super) fn index(&self, index: usize) -> u32 {
        self.locate(index).map_or(0, |(bytes, start)| self.component.read_index(bytes, start))
    }
}

impl<'b> Exceptions<'b> {
    fn new(
        exceptions: u64,
        count: usize,
        kind: Component,
        indices: View<'b>,
        values: View<'b>,
        size: usize,
    ) -> Result<Self, String> {
        // Not more than there are elements, so the numbers of both fit 32 bits.
        let exceptions = usize::try_from(exceptions).ok().filter(|&exceptions| exceptions <= count);
        let exceptions = exceptions.ok_or("it has more sparse values than elements")?;
        let indices = Elements::new(indices, exceptions, kind.size())
            .map_err(|what| format!("sparse indices: {what}"))?;
        let values =
            Elements::new(values, exceptions, size).map_err(|what| format!("sparse values: {what}"))?;
        let place = |row: usize| kind.read_index(indices.bytes, indices.start(row));
        let mut places: Vec<(u32, u32)> = (0..exceptions).map(|row| (place(row), row as u32)).collect();
        places.sort_unstable();
        match places.last() {
            Some(&(last, _)) if last as usize >= count => {
                Err(format!("a sparse value is for element {last} of {count}"))
            }
            _ => Ok(Self { places, values }),
        }
    }

    fn find(&self, index: usize) -> Option<usize> {
        let behind = self.places.partition_point(|&(place, _)| place as usize <= index);
        let &(place, row) = self.places.get(behind.checked_sub(1)?)?;
        (place as usize == index).then_some(row as usize)
    }
}
