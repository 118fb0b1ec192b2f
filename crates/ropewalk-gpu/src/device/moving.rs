//! A structure that changes from frame to frame, on either device.

use super::{Device, Traceable};
use crate::{GpuError, StructureVersions, UploadReport};
use ropewalk::Structure;
use std::sync::Arc;

/// A structure that changes, on a device. On a graphics adapter a new version sends what differs from the one before the last;
/// what is traced meanwhile stays whole for as long as its [`Traceable`] is kept.
#[derive(Debug)]
pub struct Moving {
    device: Device,
    versions: Option<StructureVersions>,
}

impl Device {
    /// Puts the first version of a structure that will change where this device can trace it.
    ///
    /// # Errors
    /// When it does not fit the device.
    pub fn prepare_moving(&self, first: impl Into<Arc<Structure>>) -> Result<(Moving, Traceable), GpuError> {
        let structure = first.into();
        let versions = match self {
            Self::Cpu => None,
            Self::Gpu(tracer) => Some(StructureVersions::new(tracer, &structure)?),
        };
        let uploaded = versions.as_ref().map(StructureVersions::current);
        let traceable = Traceable { device: self.clone(), structure, uploaded };
        Ok((Moving { device: self.clone(), versions }, traceable))
    }
}

impl Moving {
    /// Puts the next version there; on a graphics adapter, with what that sent.
    ///
    /// # Errors
    /// When it does not fit the device, or the device fails.
    pub fn advance(
        &mut self,
        next: impl Into<Arc<Structure>>,
    ) -> Result<(Traceable, Option<UploadReport>), GpuError> {
        let structure = next.into();
        let report = self.versions.as_ref().map(|versions| versions.upload(&structure)).transpose()?;
        // Nobody else uploads: this is the only handle.
        let uploaded = self.versions.as_ref().map(StructureVersions::current);
        Ok((Traceable { device: self.device.clone(), structure, uploaded }, report))
    }
}
