use controller_core::certificate::certified::Certified;
use controller_core::flight::*;
use host_sim::piloted::*;
use scenario::Scenario;
use std::time::Instant;
fn main(){
    let f=std::env::args().nth(1).unwrap();
    let s=Scenario::load(std::path::Path::new(&f)).unwrap();
    let c=Certified::new(s.configuration.clone()).unwrap();
    let mut place=Place::new(&s.configuration);
    let mut v=PilotedVehicle::new(&s,Ok(&c),&FlightSettings::DEFAULT,&mut place,0).unwrap();
    let t=Instant::now();
    let mut last=Mode::Boot;
    for k in 0..200_000u64 {
        let request=match k {200=>Some(Request::Arm),250=>Some(Request::TakeOff(Some(3.0))),_=>None};
        let (o,_)=v.tick(&Inputs{request,ground_station:Some(v.now()),..Inputs::default()},&mut Nobody).unwrap();
        if o.mode!=last {println!("{k} {:?} {:?} {:?}",o.mode,o.transition, v.vehicle().state().position); last=o.mode;}
        if let Some(a)=o.answer {println!("{k} {a:?}");}
    }
    println!("{:?} {:?}",t.elapsed(),v.vehicle().state());
}
