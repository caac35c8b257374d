use cohelm::human::{HumanPilot,Population}; use cohelm::pilot::Pilot; use cohelm::plant::{Plant,Ending}; use cohelm::random::Draws; use cohelm_arm::*;
fn main(){
 let mut d=Arm::new(ArmOptions::default()); let (mut own,mut other)=(0,0); let mut sp=[0;10];
 for s in 0..300u64{ let mut draws=Draws::new(s%10); let traits=Population::Ordinary.ranges().draw(&mut draws);
  let sk=pilots::Reaching::draw(d.space(),&mut draws).unwrap(); let mut p=HumanPilot::new(traits,Box::new(sk),d.space()).unwrap();
  d.reset(s); p.begin(s); loop{ let g=d.pilot_goal(); let a=p.ask(&d.view(),g); let st=d.step(a); let v=d.view(); if let Some(e)=st.ending{ if e==Ending::Crash{ if v.nearest_goal()==g{own+=1; let sp0=(v.state[2].hypot(v.state[3])*0.4/0.28*10.0) as usize; sp[sp0.min(9)]+=1;}else{other+=1}} break}}}
 println!("own {own} other {other} {sp:?}");
}
