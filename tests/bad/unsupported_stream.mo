//! model M
//! E017 at 6: "stream"
connector Port
  Real p;
  flow Real m_flow;
  stream Real h;
end Port;
model M
  Port port;
end M;
