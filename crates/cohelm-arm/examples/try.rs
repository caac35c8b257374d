use cohelm::human::{HumanPilot,Population}; use cohelm::pilot::Pilot; use cohelm::plant::Plant; use cohelm::random::Draws; use cohelm_arm::*;
use std::collections::BTreeMap;
fn main(){
 let mut d=Arm::new(ArmOptions::default());
 let mut n:BTreeMap<&str,u32>=BTreeMap::new(); let mut t=0;
 for s in 0..300{ d.reset(s); loop{ let a={let g=d.pilot_goal(); d.teacher(g)}; let st=d.step(a); if let Some(e)=st.ending{*n.entry(e.word()).or_default()+=1; t+=d.view().tick; break}}}
 println!("teacher {n:?} {}",t/300);
 let mut n:BTreeMap<&str,u32>=BTreeMap::new(); let mut t=0;
 for s in 0..300u64{ let mut draws=Draws::new(s%10); let traits=Population::Ordinary.ranges().draw(&mut draws);
  let sk=pilots::Reaching::draw(d.space(),&mut draws).unwrap(); let mut p=HumanPilot::new(traits,Box::new(sk),d.space()).unwrap();
  d.reset(s); p.begin(s); loop{ let g=d.pilot_goal(); let a=p.ask(&d.view(),g); let st=d.step(a); if let Some(e)=st.ending{*n.entry(e.word()).or_default()+=1; t+=d.view().tick; break}}}
 println!("human {n:?} {}",t/300);
}
