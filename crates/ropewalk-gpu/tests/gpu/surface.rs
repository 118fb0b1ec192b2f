//! The public surface as a program uses it: one way to trace, whatever the device.

use crate::compare::compare;
use crate::machine::on_every_adapter;
use crate::{rays, scenes};
use ropewalk::{
    BuildOptions, DeviceKind, Query, Ray, Scene, Structure, StructureKind, TraceOptions, Walk, catalogue,
    glam::Vec3,
};
use ropewalk_gpu::{AdapterSummary, Device, DeviceChoice, GpuError, Tracer, adapters};

fn structure() -> Structure {
    Structure::Bvh(Scene::from_mesh(scenes::sphere(12)).build(&BuildOptions::default()).unwrap())
}

#[test]
fn handles_go_between_threads() {
    fn shared<T: Send + Sync + Clone>() {}
    shared::<Tracer>();
    shared::<Device>();
    shared::<ropewalk_gpu::Gpu>();
    shared::<ropewalk_gpu::GpuStructure>();
    shared::<ropewalk_gpu::Traceable>();
}

/// The CPU is always there, with or without a driver.
#[test]
fn the_cpu_is_a_device() {
    let opened = Device::open(&DeviceChoice::Cpu).unwrap();
    assert_eq!((opened.device.kind(), opened.note), (DeviceKind::Cpu, None));
    assert_eq!(opened.device.to_string(), "cpu");
    let traceable = opened.device.prepare(structure()).unwrap();
    let rays = [Ray::new(Vec3::new(0.1, 0.2, 5.0), -Vec3::Z)];
    let rows = catalogue::rows().into_iter();
    for row in rows.filter(|row| row.device == DeviceKind::Cpu && row.structure.kind() == StructureKind::Bvh)
    {
        let traced = traceable.trace(row.walk, row.query, &rays, TraceOptions::default()).unwrap();
        assert_eq!(traced.answer.rays_that_hit(), 1);
    }
    let refused = traceable.trace(Walk::Recursive, Query::All, &rays, TraceOptions::default());
    assert!(matches!(refused, Err(GpuError::Catalogue(_))));
}

#[test]
fn auto_takes_hardware_or_the_cpu() {
    let opened = Device::open(&DeviceChoice::Auto).unwrap();
    match &opened.device {
        Device::Cpu => {
            assert!(!adapters().iter().any(|adapter| !adapter.is_software) || opened.note.is_some());
        }
        Device::Gpu(tracer) => assert!(!tracer.gpu().is_software()),
    }
}

#[test]
fn without_an_adapter_a_gpu_is_an_error() {
    if adapters().is_empty() {
        for choice in ["gpu", "gpu:0", "gpu:llvmpipe"] {
            assert_eq!(Device::open(&choice.parse().unwrap()).unwrap_err(), GpuError::NoAdapter);
        }
    }
}

/// Every way to name an adapter opens it, and a software one is announced.
#[test]
fn an_adapter_opens_by_any_name_it_has() {
    let structure = structure();
    let rays = rays::against(&structure);
    let options = TraceOptions { counters: true };
    let cpu = structure.trace(Walk::default(), Query::Closest, &rays, options).unwrap();
    on_every_adapter(|machine| {
        let there = adapters();
        let name = &machine.gpu().info().name;
        let index = there.iter().position(|adapter| adapter.name == *name).unwrap();
        let part: String = name.chars().take(5).collect::<String>().to_uppercase();
        for choice in [DeviceChoice::Gpu, DeviceChoice::GpuIndex(index), DeviceChoice::GpuName(part)] {
            let opened = Device::open(&choice).unwrap();
            let Device::Gpu(tracer) = &opened.device else { panic!("{choice} is not the CPU") };
            assert_eq!(opened.note.is_some(), tracer.gpu().is_software(), "{:?}", opened.note);
            if let Some(note) = &opened.note {
                assert!(note.contains("software") && note.contains(&tracer.gpu().info().name), "{note}");
            }
            let traceable = opened.device.prepare(structure.clone()).unwrap();
            assert_eq!(traceable.structure().triangles().len(), structure.triangles().len());
            assert_eq!(traceable.device().kind(), DeviceKind::Gpu);
            let (gpu, time) = traceable.trace_timed(Walk::default(), Query::Closest, &rays, options).unwrap();
            assert_eq!(compare(&cpu, &gpu, machine.is_exact()), Ok(()));
            assert_eq!(time.is_some(), tracer.gpu().has_timestamps());
        }
    });
}

#[test]
fn adapters_are_numbered_and_described() {
    for (index, adapter) in adapters().iter().enumerate() {
        assert_eq!(adapter.index, index);
        let text = adapter.to_string();
        assert!(text.starts_with(&format!("gpu:{index} {}", adapter.name)), "{text}");
        assert_eq!(text.contains("software"), adapter.is_software, "{text}");
    }
    on_every_adapter(|machine| {
        let summary = AdapterSummary::new(3, machine.gpu().info());
        assert_eq!(summary.to_string(), format!("gpu:3 {}", machine.gpu().describe()));
    });
}
