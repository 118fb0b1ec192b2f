//! The adapters of this machine, and which of them a caller means.
//!
//! Adapters are numbered as wgpu lists them; those that run no compute shaders are left out. A *software*
//! adapter (lavapipe, SwiftShader, WARP) runs on the processor: it is never taken where a hardware one would do.

use crate::GpuError;
use std::fmt;
use std::str::FromStr;

/// An adapter, as it is shown to people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// Its number, for [`DeviceChoice::GpuIndex`].
    pub index: usize,
    /// The name that its driver gives it.
    pub name: String,
    /// The programming interface behind it.
    pub backend: wgpu::Backend,
    /// The driver and its version.
    pub driver: String,
    /// What kind of thing it is.
    pub kind: wgpu::DeviceType,
    /// Whether it runs on the processor.
    pub is_software: bool,
}

impl AdapterSummary {
    /// Sums up what wgpu says about an adapter.
    #[must_use]
    pub fn new(index: usize, info: &wgpu::AdapterInfo) -> Self {
        let words = [info.driver.as_str(), info.driver_info.as_str()];
        Self {
            index,
            name: info.name.clone(),
            backend: info.backend,
            driver: words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" "),
            kind: info.device_type,
            is_software: info.device_type == wgpu::DeviceType::Cpu,
        }
    }

    /// Its name, interface and driver, without the number.
    #[must_use]
    pub fn describe(&self) -> String {
        let mut words = vec![self.backend.to_string()];
        if !self.driver.is_empty() {
            words.push(self.driver.clone());
        }
        if self.is_software {
            words.push("software".into());
        }
        format!("{} ({})", self.name, words.join(", "))
    }

    /// How much it is preferred: a card of its own first, a software adapter last.
    const fn rank(&self) -> u8 {
        match self.kind {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        }
    }
}

impl fmt::Display for AdapterSummary {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "gpu:{} {}", self.index, self.describe())
    }
}

/// Where a caller wants to trace.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// A hardware adapter where there is one, else the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// The best adapter, a software one where there is nothing better.
    Gpu,
    /// The adapter of this number.
    GpuIndex(usize),
    /// The best adapter whose name contains this, upper and lower case being the same.
    GpuName(String),
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => formatter.pad("auto"),
            Self::Cpu => formatter.pad("cpu"),
            Self::Gpu => formatter.pad("gpu"),
            Self::GpuIndex(index) => formatter.pad(&format!("gpu:{index}")),
            Self::GpuName(name) => formatter.pad(&format!("gpu:{name}")),
        }
    }
}

impl FromStr for DeviceChoice {
    type Err = GpuError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match (text, text.split_once(':')) {
            ("auto", _) => Ok(Self::Auto),
            ("cpu", _) => Ok(Self::Cpu),
            ("gpu", _) => Ok(Self::Gpu),
            (_, Some(("gpu", name))) if !name.trim().is_empty() => {
                // A number too large to be one is a name, which then is not found.
                Ok(name.parse().map_or_else(|_| Self::GpuName(name.into()), Self::GpuIndex))
            }
            _ => Err(GpuError::NoSuchDevice(text.into())),
        }
    }
}

/// The adapters of this machine; none where there is no driver.
#[must_use]
pub fn adapters() -> Vec<AdapterSummary> {
    summaries(&discover())
}

/// Asks wgpu for the adapters that run compute shaders.
pub(crate) fn discover() -> Vec<wgpu::Adapter> {
    if wgpu::Instance::enabled_backend_features().is_empty() {
        return Vec::new();
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        // wgpu's own checks are always on. The layers of the Vulkan SDK come only when the environment asks.
        flags: wgpu::InstanceFlags::empty().with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.retain(|adapter| {
        adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
    });
    adapters
}

pub(crate) fn summaries(adapters: &[wgpu::Adapter]) -> Vec<AdapterSummary> {
    adapters
        .iter()
        .enumerate()
        .map(|(index, adapter)| AdapterSummary::new(index, &adapter.get_info()))
        .collect()
}

/// The number of the adapter that is meant, or `None` for the CPU.
pub(crate) fn select(choice: &DeviceChoice, there: &[AdapterSummary]) -> Result<Option<usize>, GpuError> {
    let best = |wanted: &dyn Fn(&AdapterSummary) -> bool| {
        there
            .iter()
            .filter(|adapter| wanted(adapter))
            .min_by_key(|adapter| adapter.rank())
            .map(|best| best.index)
    };
    let missing = |wanted: String| GpuError::NoSuchAdapter { wanted, there: there.to_vec() };
    match choice {
        DeviceChoice::Cpu => Ok(None),
        DeviceChoice::Auto => Ok(best(&|adapter| !adapter.is_software)),
        DeviceChoice::Gpu => best(&|_| true).map(Some).ok_or(GpuError::NoAdapter),
        _ if there.is_empty() => Err(GpuError::NoAdapter),
        DeviceChoice::GpuIndex(index) if *index < there.len() => Ok(Some(*index)),
        DeviceChoice::GpuIndex(index) => Err(missing(index.to_string())),
        DeviceChoice::GpuName(part) => {
            let part = part.to_lowercase();
            best(&|adapter| adapter.name.to_lowercase().contains(&part))
                .map(Some)
                .ok_or_else(|| missing(part))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(kinds: &[(&str, wgpu::DeviceType)]) -> Vec<AdapterSummary> {
        let adapter = |(index, &(name, kind)): (usize, &(&str, wgpu::DeviceType))| AdapterSummary {
            index,
            name: name.into(),
            backend: wgpu::Backend::Vulkan,
            driver: String::new(),
            kind,
            is_software: kind == wgpu::DeviceType::Cpu,
        };
        kinds.iter().enumerate().map(adapter).collect()
    }

    #[test]
    fn what_is_printed_is_read_back() {
        for text in
            ["auto", "cpu", "gpu", "gpu:0", "gpu:12", "gpu:GeForce RTX", "gpu:99999999999999999999999"]
        {
            assert_eq!(text.parse::<DeviceChoice>().unwrap().to_string(), text);
        }
        for text in ["", "GPU", "gpu:", "gpu: ", "cuda", "cpu:1"] {
            let error = text.parse::<DeviceChoice>().unwrap_err().to_string();
            assert!(error.contains("auto, cpu, gpu"), "{error}");
        }
    }

    #[test]
    fn hardware_comes_first_and_software_is_never_automatic() {
        use wgpu::DeviceType::{Cpu, DiscreteGpu, IntegratedGpu};
        let laptop = machine(&[("llvmpipe", Cpu), ("Iris", IntegratedGpu), ("GeForce", DiscreteGpu)]);
        assert_eq!(select(&DeviceChoice::Auto, &laptop), Ok(Some(2)));
        assert_eq!(select(&DeviceChoice::Gpu, &laptop), Ok(Some(2)));
        assert_eq!(select(&DeviceChoice::GpuName("iris".into()), &laptop), Ok(Some(1)));
        assert_eq!(select(&DeviceChoice::GpuName("PIPE".into()), &laptop), Ok(Some(0)));
        assert_eq!(select(&DeviceChoice::GpuIndex(0), &laptop), Ok(Some(0)));
        assert_eq!(select(&DeviceChoice::Cpu, &laptop), Ok(None));
        let server = machine(&[("llvmpipe", Cpu)]);
        assert_eq!(select(&DeviceChoice::Auto, &server), Ok(None));
        assert_eq!(select(&DeviceChoice::Gpu, &server), Ok(Some(0)));
    }

    #[test]
    fn what_is_not_there_is_answered_with_what_is() {
        let server = machine(&[("llvmpipe", wgpu::DeviceType::Cpu)]);
        let error = select(&DeviceChoice::GpuIndex(7), &server).unwrap_err().to_string();
        assert!(error.contains("'7'") && error.contains("gpu:0 llvmpipe (vulkan, software)"), "{error}");
        let error = select(&DeviceChoice::GpuName("radeon".into()), &server).unwrap_err().to_string();
        assert!(error.contains("radeon") && error.contains("llvmpipe"), "{error}");
        assert_eq!(select(&DeviceChoice::Gpu, &[]), Err(GpuError::NoAdapter));
        assert_eq!(select(&DeviceChoice::GpuIndex(0), &[]), Err(GpuError::NoAdapter));
        assert_eq!(select(&DeviceChoice::Auto, &[]), Ok(None));
    }
}
