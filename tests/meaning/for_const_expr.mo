//! model P.M
//! T[1,1](0.17) = 1.87
//! T[1,1](0.63) = 6.93
//! T[2,3](0.17) = 3.91
//! T[2,3](0.63) = 14.49
//! diag[2](0.17) = 3.74
//! diag[2](0.63) = 13.86
//! row(0.17) = 6.12
//! row(0.63) = 22.68
//! tt[3,1](0.17) = 2.21
//! tt[3,1](0.63) = 8.19
//! c2[1](0.17) = 2.04
//! c2[1](0.63) = 7.56
//! sub[1,1](0.17) = 2.04
//! sub[1,1](0.63) = 7.56
//! sub[2,2](0.17) = 3.91
//! sub[2,2](0.63) = 14.49
//! mm(0.17) = 3.91
//! mm(0.63) = 14.49
//! nz(0.89) = 0
package P
  model M
    constant Integer nr = 2, nc = 3;
    Real T[nr, nc];
    Real diag[min(nr, nc)] = {T[i, i] for i in 1:min(nr, nc)};
    Real row = sum(T[1, :]);
    Real tt[nc, nr] = transpose(T);
    Real c2[nr] = T[:, 2];
    Real sub[2, 2] = T[:, 2:end];
    Real mm = max(T[nr, :]);
    Real e[0];
    Real nz = sum(e);
  equation
    for i in 1:nr loop
      for j in 1:nc loop
        T[i, j] = (10*i + j)*time;
      end for;
    end for;
  end M;
end P;
